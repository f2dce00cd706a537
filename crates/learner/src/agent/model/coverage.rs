//! Incremental counts of the evidence for and against every condition of one or two alleles.

use std::collections::BTreeMap;

use crate::agent::model::tally::{Tally, verdict};
use xcs::{Condition, Percept};

/// The maximum width of percepts with candidates of two alleles. Wider ones would have too many pairs.
const WIDEST_FOR_PAIRS: usize = 64;

/// By condition, the number of matching percepts in which the action bumped, and in which it moved. A
/// percept matches one condition of each pair of alleles. So the cost of a new verdict is independent of
/// the number of percepts.
#[derive(Debug, Clone, Default)]
pub(super) struct Coverage {
    /// By pair of alleles, in the order of [`pairs`], and by the values of the two alleles.
    tallies: Vec<[Tally; 4]>,
}

impl Coverage {
    /// Counts the evidence on percepts of one width, with verdicts at this margin.
    pub fn of(width: usize, evidence: &BTreeMap<Percept, Tally>, margin: u32) -> Self {
        let mut coverage = Self {
            tallies: vec![Default::default(); pairs(width).count()],
        };
        for (percept, &tally) in evidence {
            coverage.change(percept, None, verdict(tally, margin));
        }
        coverage
    }

    /// Updates the counts after the verdict on a percept has changed.
    pub fn change(&mut self, percept: &Percept, before: Option<bool>, after: Option<bool>) {
        for (tallies, alleles) in self.tallies.iter_mut().zip(pairs(percept.width())) {
            let tally = &mut tallies[values(percept, alleles)];
            tally.take_back(before);
            tally.add(after);
        }
    }

    /// Returns all conditions of one or two alleles that match a percept, with their counts.
    pub fn conditions(&self, percept: &Percept) -> impl Iterator<Item = (Condition, Tally)> {
        let tallies = self.tallies.iter().zip(pairs(percept.width()));
        tallies.map(move |(tallies, alleles)| {
            let condition = Condition::of_alleles(percept, alleles);
            (condition, tallies[values(percept, alleles)])
        })
    }
}

/// Returns all pairs of alleles, including each allele with itself.
fn pairs(width: usize) -> impl Iterator<Item = [usize; 2]> {
    let second = move |first| match width > WIDEST_FOR_PAIRS {
        true => first..first + 1,
        false => first..width,
    };
    (0..width).flat_map(move |first| second(first).map(move |second| [first, second]))
}

/// Returns the index of the values of two alleles.
fn values(percept: &Percept, [first, second]: [usize; 2]) -> usize {
    2 * usize::from(percept.bit(first)) + usize::from(percept.bit(second))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_counts_of_each_condition_are_those_of_the_percepts_that_it_matches(
            verdicts in prop::collection::vec((0_u64..32, any::<bool>()), 1..60), asked in 0_u64..32,
        ) {
            let (early, late) = verdicts.split_at(verdicts.len() / 2);
            let mut evidence = BTreeMap::<Percept, Tally>::new();
            let learn = |evidence: &mut BTreeMap<Percept, Tally>, word, bumped| {
                let percept = Percept::from_word(word, 5);
                let tally = evidence.entry(percept).or_default();
                let before = verdict(*tally, 0);
                tally.add(Some(bumped));
                (percept, before, verdict(*tally, 0))
            };
            for &(word, bumped) in early {
                learn(&mut evidence, word, bumped);
            }
            let mut coverage = Coverage::of(5, &evidence, 0);
            for &(word, bumped) in late {
                let (percept, before, after) = learn(&mut evidence, word, bumped);
                coverage.change(&percept, before, after);
            }
            let conditions: Vec<_> = coverage.conditions(&Percept::from_word(asked, 5)).collect();
            prop_assert_eq!(conditions.len(), 15);
            for (condition, tally) in conditions {
                let mut counted = Tally::default();
                let matched = evidence.iter().filter(|(percept, _)| condition.matches(percept));
                matched.for_each(|(_, &one)| counted.add(verdict(one, 0)));
                prop_assert_eq!(tally, counted);
            }
        }
    }
}
