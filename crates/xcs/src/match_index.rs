//! An inverted bit index that finds the rules matching a percept, 64 rules at a time.

use super::condition::Condition;
use super::representation::Index;
use crate::percept::{MAX_PERCEPT_BITS, Percept};
use crate::ranges::Ranges;

/// Alleles per look-up.
const ALLELES: usize = 4;
/// Possible values of [`ALLELES`] bits.
const VALUES: usize = 1 << ALLELES;
/// The mask for the bits of one look-up.
const MASK: u64 = VALUES as u64 - 1;
/// Look-ups between two checks whether any rule is left. For most wide percepts, the first check
/// already ends the search.
const GROUP: usize = 4;

/// For each four percept bits and each of their values, a bitmap of the rules excluded by that
/// value.
///
/// A percept is matched by the rules that none of its bits excludes. The bitmaps of each block of
/// 64 rules are contiguous. Matching therefore reads memory sequentially and stops early when no
/// rule is left. Adding or removing a rule changes one block of `4 * width` words. Tables of eight
/// bits would halve the look-ups but take eight times the memory.
#[derive(Debug, Clone, Default)]
pub struct MatchIndex {
    /// For each 64 rules, one table per four alleles: the rules excluded by each value.
    ruled_out: Vec<[u64; VALUES]>,
    /// The number of tables per 64 rules.
    tables: usize,
    rules: usize,
    /// By rule, the ranges of its condition.
    ranges: Vec<Ranges>,
}

impl Index<Condition> for MatchIndex {
    fn push(&mut self, condition: &Condition) {
        if self.rules == 0 {
            self.tables = condition.width().div_ceil(ALLELES);
        }
        let (block, bit) = (self.rules / 64 * self.tables, self.rules % 64);
        if bit == 0 {
            self.ruled_out.resize(block + self.tables, [0; VALUES]);
        }
        for (at, table) in self.ruled_out[block..].iter_mut().enumerate() {
            let [care, value] = condition.words_of(at * ALLELES);
            for (bits, out) in table.iter_mut().enumerate() {
                let is_wrong = (bits as u64 ^ value) & care & MASK != 0;
                *out |= u64::from(is_wrong) << bit;
            }
        }
        self.rules += 1;
        self.ranges.push(*condition.number_ranges());
    }

    fn swap_remove(&mut self, position: usize) {
        self.rules -= 1;
        self.ranges.swap_remove(position);
        let (to, from) = (position % 64, self.rules % 64);
        let (to_block, from_block) = (position / 64 * self.tables, self.rules / 64 * self.tables);
        for at in 0..self.tables {
            for value in 0..VALUES {
                let moved = self.ruled_out[from_block + at][value] >> from & 1;
                self.ruled_out[from_block + at][value] &= !(1 << from);
                if position != self.rules {
                    let word = &mut self.ruled_out[to_block + at][value];
                    *word = *word & !(1 << to) | moved << to;
                }
            }
        }
        self.ruled_out
            .truncate(self.rules.div_ceil(64) * self.tables);
    }

    fn for_each_match(&self, percept: &Percept, mut found: impl FnMut(usize)) {
        let mut values = [0; MAX_PERCEPT_BITS / ALLELES];
        let values = &mut values[..self.tables];
        cut(percept, values);
        for first in (0..self.rules).step_by(64) {
            let block = &self.ruled_out[first / 64 * self.tables..][..self.tables];
            let existing = u64::MAX >> (64 - (self.rules - first).min(64));
            let mut matching = !ruled_out_by(values, block) & existing;
            while matching != 0 {
                let at = first + matching.trailing_zeros() as usize;
                if self.ranges[at].match_all(percept) {
                    found(at);
                }
                matching &= matching - 1;
            }
        }
    }
}

/// Splits the first bits of a percept into numbers of four bits.
fn cut(percept: &Percept, values: &mut [u8]) {
    for (at, value) in values.iter_mut().enumerate() {
        let bit = at * ALLELES;
        *value = (percept.words()[bit / 64] >> (bit % 64)) as u8 % VALUES as u8;
    }
}

/// Returns a mask of the rules, out of 64, that a percept excludes.
fn ruled_out_by(values: &[u8], block: &[[u64; VALUES]]) -> u64 {
    let mut out = 0;
    for (values, tables) in values.chunks(GROUP).zip(block.chunks(GROUP)) {
        for (&value, table) in values.iter().zip(tables) {
            out |= table[usize::from(value) % VALUES];
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
            conditions in prop::collection::vec("[01#]{9}|[01#]{4}\\[[0-3]-[4-6]:3\\][01#]{2}", 0..200),
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
