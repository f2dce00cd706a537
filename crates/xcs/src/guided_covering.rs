//! Guided covering: the most general condition for a percept that no labelled example contradicts.
//!
//! Random covering puts don't-cares anywhere. Where the correct payoff of many percepts is known, a search finds a
//! condition under which all of them have the same payoff.

use fixedbitset::FixedBitSet;

use crate::action::Action;
use crate::condition::Condition;
use crate::labelled_examples::LabelledExamples;
use crate::layout::Feature;
use crate::percept::Percept;

impl LabelledExamples {
    /// Returns the most general condition that greedy search finds for the percept of example `number`, so that in all
    /// examples that it matches, `action` is one of the best (`is_best`), or in none of them.
    ///
    /// Returns `None` if there is no such example, if it has another label, or if another example with the same percept
    /// has.
    pub fn general_condition(
        &self,
        number: usize,
        action: Action,
        is_best: bool,
    ) -> Option<Condition> {
        let best = self.given_where(action);
        let others = without(self.given(), best);
        let [wanted, contradicting] = match is_best {
            true => [best, &others],
            false => [&others, best],
        };
        self.condition_for(number, wanted, contradicting)
    }

    /// Returns a condition that matches as many as possible of the `wanted` examples, which are true where the action is
    /// one of the best, among them example `number`, and no example in which the action is not. `None` as for
    /// [`general_condition`](Self::general_condition).
    pub(super) fn condition_matching(
        &self,
        number: usize,
        action: Action,
        wanted: &FixedBitSet,
    ) -> Option<Condition> {
        let contradicting = without(self.given(), self.given_where(action));
        self.condition_for(number, wanted, &contradicting)
    }

    /// Like [`condition_matching`](Self::condition_matching), found the other way round: begins with the percept alone,
    /// and generalises the condition to one wanted example after the other, the most similar one first.
    pub(super) fn grown_condition(
        &self,
        number: usize,
        action: Action,
        wanted: &FixedBitSet,
    ) -> Option<Condition> {
        let percept = &self.get(number)?.percept;
        let contradicting = &without(self.given(), self.given_where(action));
        let search = Search {
            examples: self,
            percept,
            wanted,
            contradicting,
        };
        let features = search.needed(search.shared()?);
        Some(search.condition(&features))
    }

    fn condition_for(
        &self,
        number: usize,
        wanted: &FixedBitSet,
        contradicting: &FixedBitSet,
    ) -> Option<Condition> {
        let percept = &self.get(number)?.percept;
        let search = Search {
            examples: self,
            percept,
            wanted,
            contradicting,
        };
        let features = search.needed(search.sufficient()?);
        Some(search.condition(&features))
    }
}

/// A search for the features that a condition must share with a percept.
struct Search<'a> {
    examples: &'a LabelledExamples,
    percept: &'a Percept,
    /// The examples that the condition should match.
    wanted: &'a FixedBitSet,
    /// The examples that the condition must not match.
    contradicting: &'a FixedBitSet,
}

impl Search<'_> {
    /// Adds features until the condition matches no contradicting example. Each step adds the feature that leaves the
    /// highest share of wanted examples, (good + 1) / (all + 2), as CN2 does (Clark and Niblett 1989).
    fn sufficient(&self) -> Option<Vec<Feature>> {
        let mut features = Vec::new();
        let mut matched = self.wanted.clone();
        matched.union_with(self.contradicting);
        loop {
            let bad = matched.intersection_count(self.contradicting);
            if bad == 0 {
                return Some(features);
            }
            let mut best: Option<(Feature, [u64; 2])> = None;
            for feature in self.examples.features() {
                let [left, wrong] =
                    self.examples
                        .count(&matched, self.contradicting, feature, self.has(feature));
                let share = [u64::from(left) + 1, u64::from(left + wrong) + 2];
                let is_better = |&(_, [a, b]): &(_, [u64; 2])| share[0] * b > a * share[1];
                if (wrong as usize) < bad && best.as_ref().is_none_or(is_better) {
                    best = Some((feature, share));
                }
            }
            let (feature, _) = best?;
            features.push(feature);
            matched = self
                .examples
                .with_feature(&matched, feature, self.has(feature));
        }
    }

    /// Returns the features that the percept shares with as many wanted examples as possible, so that no contradicting
    /// example shares them.
    fn shared(&self) -> Option<Vec<Feature>> {
        let layout = self.examples.layout();
        let agrees = |at: usize, feature: Feature| {
            let percept = &self.examples.get(at)?.percept;
            Some(layout.is_true(feature, percept) == self.has(feature))
        };
        let mut features: Vec<Feature> = self.examples.features().collect();
        if !self.matched(&features).is_disjoint(self.contradicting) {
            return None;
        }
        let differing = |at: usize| {
            let all = features.iter();
            all.filter(|&&feature| agrees(at, feature) == Some(false))
                .count()
        };
        let mut others: Vec<(usize, usize)> =
            self.wanted.ones().map(|at| (differing(at), at)).collect();
        others.sort_unstable();
        for (_, at) in others {
            let left = features.iter().copied();
            let left: Vec<Feature> = left.filter(|&f| agrees(at, f) == Some(true)).collect();
            if self.matched(&left).is_disjoint(self.contradicting) {
                features = left;
            }
        }
        Some(features)
    }

    /// Drops each feature without which the condition still matches no contradicting example.
    fn needed(&self, mut features: Vec<Feature>) -> Vec<Feature> {
        for feature in features.clone() {
            let fewer: Vec<Feature> = features.iter().copied().filter(|&f| f != feature).collect();
            if self.matched(&fewer).is_disjoint(self.contradicting) {
                features = fewer;
            }
        }
        features
    }

    /// Returns the condition that requires these features. The limit of a number lies in the middle of the gap between
    /// the matched examples and the contradicting ones.
    fn condition(&self, features: &[Feature]) -> Condition {
        let centred = features
            .iter()
            .map(|&feature| self.centred(feature, features));
        self.examples.layout().condition(self.percept, centred)
    }

    /// Moves the limit of a number to the middle of its gap.
    fn centred(&self, feature: Feature, features: &[Feature]) -> Feature {
        let Feature::Above(number, limit) = feature else {
            return feature;
        };
        let others: Vec<Feature> = features.iter().copied().filter(|&f| f != feature).collect();
        let open = self.matched(&others);
        let is_above = self.has(feature);
        let numbers = |set: FixedBitSet| {
            let numbers = set
                .into_ones()
                .filter_map(|at| self.examples.number_in(at, number));
            numbers.collect::<Vec<u16>>()
        };
        let inside = numbers(self.examples.with_feature(&open, feature, is_above));
        let mut excluded = open;
        excluded.intersect_with(self.contradicting);
        let outside = numbers(excluded);
        let gap = match is_above {
            true => outside.into_iter().max().zip(inside.into_iter().min()),
            false => inside.into_iter().max().zip(outside.into_iter().min()),
        };
        match gap {
            Some((below, above)) if below < above => {
                Feature::Above(number, below + (above - 1 - below) / 2)
            }
            _ => Feature::Above(number, limit),
        }
    }

    /// Returns the examples that share these features with the percept.
    fn matched(&self, features: &[Feature]) -> FixedBitSet {
        let narrow = |some, &feature: &Feature| {
            self.examples
                .with_feature(&some, feature, self.has(feature))
        };
        features.iter().fold(self.examples.given().clone(), narrow)
    }

    /// Returns true if a feature is true in the percept.
    fn has(&self, feature: Feature) -> bool {
        self.examples.layout().is_true(feature, self.percept)
    }
}

fn without(all: &FixedBitSet, some: &FixedBitSet) -> FixedBitSet {
    let mut left = all.clone();
    left.difference_with(some);
    left
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::action::ByAction;
    use crate::labelled_examples::LabelledExample;
    use crate::layout::Layout;

    /// Returns examples of four-bit percepts whose first bit is free and whose last three bits are a number; action 0 is
    /// best in percepts that `holds` accepts, and action 1 elsewhere.
    fn examples(percepts: &[&str], holds: fn(&str) -> bool) -> LabelledExamples {
        let layout = Layout::with_numbers(std::iter::once(1..4)).unwrap();
        let mut examples = LabelledExamples::new(layout);
        for (number, text) in percepts.iter().enumerate() {
            let mut best = ByAction::default();
            best[usize::from(!holds(text))] = true;
            let percept = text.parse().unwrap();
            examples.give(number, LabelledExample { percept, best });
        }
        examples
    }

    fn condition(examples: &LabelledExamples, number: usize, is_best: bool) -> Option<String> {
        let action = Action::new(0).unwrap();
        let condition = examples.general_condition(number, action, is_best);
        condition.map(|condition| condition.to_string())
    }

    #[test]
    fn a_bit_that_decides_is_the_only_one_that_is_required() {
        let examples = examples(&["0000", "0101", "1000", "1101"], |text| {
            text.starts_with('1')
        });
        assert_eq!(condition(&examples, 2, true).unwrap(), "1###");
        assert_eq!(condition(&examples, 0, false).unwrap(), "0###");
        assert_eq!(condition(&examples, 0, true), None, "another label");
    }

    #[test]
    fn the_limit_of_a_number_lies_in_the_middle_of_the_gap() {
        let examples = examples(&["0000", "0001", "0110", "0111"], |text| text >= "0110");
        assert_eq!(condition(&examples, 2, true).unwrap(), "#[4-7:3]");
        assert_eq!(condition(&examples, 0, false).unwrap(), "#[0-3:3]");
    }

    #[test]
    fn two_labels_of_one_percept_have_no_condition() {
        let mut examples = examples(&["0000", "0000"], |_| true);
        assert!(condition(&examples, 0, true).is_some(), "control");
        let mut other = *examples.get(1).unwrap();
        other.best = ByAction::default();
        other.best[1] = true;
        examples.give(1, other);
        assert_eq!(condition(&examples, 0, true), None);
    }

    #[test]
    fn a_grown_condition_matches_many_wanted_examples_and_no_contradicting_one() {
        let examples = examples(&["0000", "0101", "1000", "1101"], |text| {
            text.starts_with('1')
        });
        let action = Action::new(0).unwrap();
        let grown = |number| {
            let wanted = examples.given_where(action);
            let condition = examples.grown_condition(number, action, wanted);
            condition.map(|condition| condition.to_string())
        };
        assert_eq!(grown(2).unwrap(), "1###");
        assert_eq!(grown(0), None, "control: another label");
    }
}
