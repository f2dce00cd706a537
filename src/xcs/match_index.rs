//! Inverted bit index: which rules match a percept, 64 rules at a time.

use super::condition::Condition;
use crate::signal::Percept;

/// For each percept bit and each value of it, a bitmap of the rules which that value rules out.
///
/// A percept is matched by the rules that none of its bits rules out. The cost of a match is
/// `width * rules / 64` machine words, and adding or removing a rule touches `2 * width` bits.
#[derive(Debug, Clone, Default)]
pub(super) struct MatchIndex {
    /// Row `2 * bit + value`; one bit per rule, by position.
    ruled_out: Vec<Vec<u64>>,
    rules: usize,
}

impl MatchIndex {
    /// Adds a rule at the next position. All rules have the same width.
    pub fn push(&mut self, condition: &Condition) {
        let rows = 2 * condition.width();
        self.ruled_out
            .resize(rows, vec![0; self.rules.div_ceil(64)]);
        let (word, bit) = (self.rules / 64, self.rules % 64);
        if bit == 0 {
            self.ruled_out.iter_mut().for_each(|row| row.push(0));
        }
        for allele in 0..condition.width() {
            if let Some(value) = condition.allele(allele) {
                self.ruled_out[2 * allele + usize::from(!value)][word] |= 1 << bit;
            }
        }
        self.rules += 1;
    }

    /// Removes the rule at `position`; the last rule takes its place.
    pub fn swap_remove(&mut self, position: usize) {
        self.rules -= 1;
        let (to, from) = (
            (position / 64, position % 64),
            (self.rules / 64, self.rules % 64),
        );
        for row in &mut self.ruled_out {
            let moved = row[from.0] >> from.1 & 1;
            row[from.0] &= !(1 << from.1);
            if position != self.rules {
                row[to.0] = row[to.0] & !(1 << to.1) | moved << to.1;
            }
            row.truncate(self.rules.div_ceil(64));
        }
    }

    /// Calls `found` with the position of each rule that matches, in ascending order.
    /// `scratch` is working space.
    pub fn for_each_match(
        &self,
        percept: &Percept,
        scratch: &mut Vec<u64>,
        mut found: impl FnMut(usize),
    ) {
        scratch.clear();
        scratch.resize(self.rules.div_ceil(64), 0);
        for bit in 0..self.ruled_out.len() / 2 {
            let row = &self.ruled_out[2 * bit + usize::from(percept.bit(bit))];
            scratch
                .iter_mut()
                .zip(row)
                .for_each(|(out, word)| *out |= word);
        }
        for (word, &out) in scratch.iter().enumerate() {
            let existing = u64::MAX >> (64 - (self.rules - 64 * word).min(64));
            let mut matching = !out & existing;
            while matching != 0 {
                found(64 * word + matching.trailing_zeros() as usize);
                matching &= matching - 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn the_index_finds_what_matching_each_rule_finds(
            conditions in prop::collection::vec("[01#]{9}", 0..200),
            removed in prop::collection::vec(any::<prop::sample::Index>(), 0..100),
            percept in "[01]{9}",
        ) {
            let mut rules: Vec<Condition> = conditions.iter().map(|c| c.parse().unwrap()).collect();
            let percept: Percept = percept.parse().unwrap();
            let mut index = MatchIndex::default();
            rules.iter().for_each(|rule| index.push(rule));
            for position in removed {
                if !rules.is_empty() {
                    let position = position.index(rules.len());
                    rules.swap_remove(position);
                    index.swap_remove(position);
                }
            }
            let mut found = Vec::new();
            index.for_each_match(&percept, &mut Vec::new(), |position| found.push(position));
            let expected: Vec<usize> =
                (0..rules.len()).filter(|&i| rules[i].matches(&percept)).collect();
            prop_assert_eq!(found, expected);
        }
    }
}
