//! Inverted bit index: which rules match a percept, 64 rules at a time.

use super::condition::Condition;
use crate::signal::Percept;

/// Alleles between two looks at whether any rule is left; most wide percepts end at the first.
const GROUP: usize = 16;

/// For each percept bit and each value of it, a bitmap of the rules which that value rules out.
///
/// A percept is matched by the rules that none of its bits rules out. The bitmaps of each 64 rules
/// lie together, so that matching runs through memory once and stops early where no rule is left,
/// and adding or removing a rule touches one stretch of `2 * width` words.
#[derive(Debug, Clone, Default)]
pub(super) struct MatchIndex {
    /// For each 64 rules, `width` pairs: who is ruled out by a 0 and by a 1 in that place.
    ruled_out: Vec<[u64; 2]>,
    width: usize,
    rules: usize,
}

impl MatchIndex {
    /// Adds a rule at the next position. All rules have the same width.
    pub fn push(&mut self, condition: &Condition) {
        if self.rules == 0 {
            self.width = condition.width();
        }
        let (block, bit) = (self.rules / 64 * self.width, self.rules % 64);
        if bit == 0 {
            self.ruled_out.resize(block + self.width, [0; 2]);
        }
        for (allele, pair) in self.ruled_out[block..].iter_mut().enumerate() {
            if let Some(value) = condition.allele(allele) {
                pair[usize::from(!value)] |= 1 << bit;
            }
        }
        self.rules += 1;
    }

    /// Removes the rule at `position`; the last rule takes its place.
    pub fn swap_remove(&mut self, position: usize) {
        self.rules -= 1;
        let (to, from) = (position % 64, self.rules % 64);
        let (to_block, from_block) = (position / 64 * self.width, self.rules / 64 * self.width);
        for at in 0..self.width {
            for value in 0..2 {
                let moved = self.ruled_out[from_block + at][value] >> from & 1;
                self.ruled_out[from_block + at][value] &= !(1 << from);
                if position != self.rules {
                    let word = &mut self.ruled_out[to_block + at][value];
                    *word = *word & !(1 << to) | moved << to;
                }
            }
        }
        self.ruled_out
            .truncate(self.rules.div_ceil(64) * self.width);
    }

    /// Calls `found` with the position of each rule that matches, in ascending order.
    pub fn for_each_match(&self, percept: &Percept, mut found: impl FnMut(usize)) {
        for first in (0..self.rules).step_by(64) {
            let block = &self.ruled_out[first / 64 * self.width..][..self.width];
            let existing = u64::MAX >> (64 - (self.rules - first).min(64));
            let mut matching = !ruled_out_by(percept, block) & existing;
            while matching != 0 {
                found(first + matching.trailing_zeros() as usize);
                matching &= matching - 1;
            }
        }
    }
}

/// Which of 64 rules does a percept rule out?
fn ruled_out_by(percept: &Percept, block: &[[u64; 2]]) -> u64 {
    let mut out = 0;
    for (group, pairs) in block.chunks(GROUP).enumerate() {
        let mut bits = percept.words()[group * GROUP / 64] >> (group * GROUP % 64);
        for pair in pairs {
            out |= pair[(bits & 1) as usize];
            bits >>= 1;
        }
        if out == u64::MAX {
            break;
        }
    }
    out
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
            index.for_each_match(&percept, |position| found.push(position));
            let expected: Vec<usize> =
                (0..rules.len()).filter(|&i| rules[i].matches(&percept)).collect();
            prop_assert_eq!(found, expected);
        }
    }
}
