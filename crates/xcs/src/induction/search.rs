//! Greedy search for the conditions of rules (CN2, Clark and Niblett 1989).

use fixedbitset::FixedBitSet;

use crate::condition::Condition;
use crate::labelled_examples::{LabelledExample, LabelledExamples};
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
    let general = Candidate {
        condition: Condition::of_alleles(&labelled_example.percept, []),
        action,
        covers: labelled_examples.given().clone(),
    };
    let found = right_in_groups(
        labelled_examples,
        &general,
        Some(&labelled_example.percept),
        groups,
    )?;
    let mut alleles: Vec<usize> = demanded(&found.condition).collect();
    for allele in demanded(&found.condition) {
        let fewer: Vec<usize> = alleles.iter().copied().filter(|&a| a != allele).collect();
        let covers = with_alleles(labelled_examples, &labelled_example.percept, &fewer);
        if labelled_examples.verdicts(&covers, action)[1] == 0 {
            alleles = fewer;
        }
    }
    Some(Candidate {
        condition: Condition::of_alleles(&labelled_example.percept, alleles.iter().copied()),
        action,
        covers: with_alleles(labelled_examples, &labelled_example.percept, &alleles),
    })
}

fn demanded(condition: &Condition) -> impl Iterator<Item = usize> {
    let condition = *condition;
    (0..condition.width()).filter(move |&bit| condition.allele(bit).is_some())
}

/// Returns the examples whose percepts share these alleles with this percept.
fn with_alleles(
    labelled_examples: &LabelledExamples,
    percept: &Percept,
    alleles: &[usize],
) -> FixedBitSet {
    let given = labelled_examples.given().clone();
    let narrow = |some, &bit: &usize| labelled_examples.with_allele(&some, bit, percept.bit(bit));
    alleles.iter().fold(given, narrow)
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
/// only alleles of the percept `like` if one is given.
///
/// Each step adds the allele that leaves the highest share of correct examples, (good + 1) / (all +
/// 2). Returns `None` if no correct example would remain.
fn right(
    labelled_examples: &LabelledExamples,
    mut rule: Candidate,
    like: Option<&Percept>,
    end: usize,
) -> Option<Candidate> {
    loop {
        let [good, bad] = labelled_examples.verdicts(&rule.covers, rule.action);
        match (good, bad) {
            (0, _) => return None,
            (_, 0) => return Some(rule),
            _ => {}
        }
        let mut best: Option<((usize, bool), [u64; 2])> = None;
        let free = (0..end).filter(|&bit| rule.condition.allele(bit).is_none());
        for bit in free {
            for value in [false, true] {
                if like.is_some_and(|percept| percept.bit(bit) != value) {
                    continue;
                }
                let [left, wrong] =
                    labelled_examples.count(&rule.covers, (bit, value), rule.action);
                let share = [u64::from(left) + 1, u64::from(left + wrong) + 2];
                let is_better = |&(_, [a, b]): &(_, [u64; 2])| share[0] * b > a * share[1];
                if left > 0 && wrong < bad && best.as_ref().is_none_or(is_better) {
                    best = Some(((bit, value), share));
                }
            }
        }
        let ((bit, value), _) = best?;
        rule.condition = rule.condition.demanding(bit, value);
        rule.covers = labelled_examples.with_allele(&rule.covers, bit, value);
    }
}
