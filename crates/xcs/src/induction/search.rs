//! Greedy search for the conditions of rules (CN2, Clark and Niblett 1989).

use fixedbitset::FixedBitSet;

use crate::condition::Condition;
use crate::labelled_examples::{LabelledExample, LabelledExamples};
use crate::layout::Feature;
use crate::signal::{Action, Percept};

/// A rule that may join \[P\], and the examples it covers.
#[derive(Clone)]
pub(super) struct Candidate {
    pub condition: Condition,
    pub action: Action,
    pub covers: FixedBitSet,
}

/// Returns the most general rule for an example that greedy search finds. Returns `None` if another
/// example with the same percept contradicts it.
pub(super) fn covering(
    labelled_examples: &LabelledExamples,
    labelled_example: &LabelledExample,
    action: Action,
    groups: &[usize],
) -> Option<Candidate> {
    let (layout, percept) = (labelled_examples.layout(), &labelled_example.percept);
    let general = Candidate {
        condition: Condition::anything(percept.width()),
        action,
        covers: labelled_examples.given().clone(),
    };
    let found = right_in_groups(labelled_examples, &general, Some(percept), groups)?;
    let mut features = layout.required(&found.condition);
    for feature in layout.required(&found.condition) {
        let fewer: Vec<Feature> = features.iter().copied().filter(|&f| f != feature).collect();
        let covers = with_features(labelled_examples, percept, &fewer);
        if labelled_examples.verdicts(&covers, action)[1] == 0 {
            features = fewer;
        }
    }
    Some(Candidate {
        condition: layout.condition(percept, features.iter().copied()),
        action,
        covers: with_features(labelled_examples, percept, &features),
    })
}

/// Returns the examples whose percepts share these features with this percept.
fn with_features(
    labelled_examples: &LabelledExamples,
    percept: &Percept,
    features: &[Feature],
) -> FixedBitSet {
    let given = labelled_examples.given().clone();
    let layout = labelled_examples.layout();
    let narrow = |some, &feature: &Feature| {
        let value = layout.is_true(feature, percept);
        labelled_examples.with_feature(&some, feature, value)
    };
    features.iter().fold(given, narrow)
}

/// Specialises a rule as [`right`] does, with alleles from as few feature groups as possible.
pub(super) fn right_in_groups(
    labelled_examples: &LabelledExamples,
    rule: &Candidate,
    like: Option<&Percept>,
    groups: &[usize],
) -> Option<Candidate> {
    let ends = groups.iter().copied().chain([rule.condition.width()]);
    ends.into_iter()
        .find_map(|end| right(labelled_examples, rule.clone(), like, end))
}

/// Specialises a rule until it covers only examples in which its action is among the best. Uses
/// only features of bits before `end`, with the values of the percept `like` if one is given.
///
/// Each step adds the feature that leaves the highest share of correct examples, (good + 1) / (all +
/// 2). Returns `None` if no correct example would remain.
fn right(
    labelled_examples: &LabelledExamples,
    mut rule: Candidate,
    like: Option<&Percept>,
    end: usize,
) -> Option<Candidate> {
    let layout = labelled_examples.layout();
    loop {
        let [good, bad] = labelled_examples.verdicts(&rule.covers, rule.action);
        match (good, bad) {
            (0, _) => return None,
            (_, 0) => return Some(rule),
            _ => {}
        }
        let mut best: Option<((Feature, bool), [u64; 2])> = None;
        let features = layout.features(end).filter(|&feature| {
            layout.is_open(feature, &rule.condition) && labelled_examples.is_ever_true(feature)
        });
        for feature in features {
            for value in [false, true] {
                if like.is_some_and(|percept| layout.is_true(feature, percept) != value) {
                    continue;
                }
                let [left, wrong] =
                    labelled_examples.count(&rule.covers, (feature, value), rule.action);
                let share = [u64::from(left) + 1, u64::from(left + wrong) + 2];
                let is_better = |&(_, [a, b]): &(_, [u64; 2])| share[0] * b > a * share[1];
                if left > 0 && wrong < bad && best.as_ref().is_none_or(is_better) {
                    best = Some(((feature, value), share));
                }
            }
        }
        let ((feature, value), _) = best?;
        rule.condition = layout.requiring(rule.condition, feature, value);
        rule.covers = labelled_examples.with_feature(&rule.covers, feature, value);
    }
}
