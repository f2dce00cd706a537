//! Ternary conditions on percepts.

use std::fmt;
use std::hash::{Hash, Hasher};
use std::ops::Range;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::percept::{MAX_PERCEPT_BITS, PERCEPT_WORDS, Percept};
use crate::random::Stream;
use crate::ranges::{self, NumberRange, Ranges};

type Words = [u64; PERCEPT_WORDS];

/// A ternary string as wide as the percepts: `0`, `1`, or `#` for don't-care. In place of the bits of
/// a binary number, a range of the number may stand: `[4-7:4]` takes four bits, and requires a number
/// from 4 to 7. Only guided covering creates ranges (see [`Layout`](crate::Layout)).
///
/// Stored as two bit masks: the bits that must agree (`care`) and their values (`value`). `value`
/// is zero at don't-cares and under ranges, so equal conditions are equal word by word.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Condition {
    value: Words,
    care: Words,
    width: u16,
    ranges: Ranges,
}

impl Condition {
    /// Creates the condition that matches every percept of a width.
    pub(super) fn anything(width: usize) -> Self {
        Self {
            value: [0; PERCEPT_WORDS],
            care: [0; PERCEPT_WORDS],
            width: width as u16,
            ranges: Ranges::default(),
        }
    }

    /// Creates the condition that matches only this percept.
    pub fn exactly(percept: &Percept) -> Self {
        let width = percept.width();
        Self {
            value: *percept.words(),
            care: std::array::from_fn(|word| bits_between(word, 0, width)),
            ..Self::anything(width)
        }
    }

    /// Covering: returns a condition that matches the percept. Each allele is a don't-care with
    /// probability `dont_care`.
    pub fn covering(percept: &Percept, dont_care: f64, stream: &mut Stream) -> Self {
        let mut condition = Self::exactly(percept);
        for bit in 0..percept.width() {
            if stream.chance(dont_care) {
                condition.set_dont_care(bit);
            }
        }
        condition
    }

    /// Returns the condition with this value required at one more allele.
    pub(super) fn demanding(mut self, allele: usize, value: bool) -> Self {
        self.set(allele, value);
        self
    }

    /// Returns the ranges of numbers, in the order of their bits.
    pub fn ranges(&self) -> impl Iterator<Item = &NumberRange> {
        self.ranges.iter()
    }

    /// Returns the ranges for an index.
    pub(super) fn number_ranges(&self) -> &Ranges {
        &self.ranges
    }

    /// Returns the condition with the range of a number in place of everything required of its bits.
    pub(super) fn within(mut self, range: NumberRange) -> Self {
        range.bits().for_each(|bit| self.set_dont_care(bit));
        self.ranges.set(range);
        self
    }

    /// Returns the number of alleles.
    pub fn width(&self) -> usize {
        usize::from(self.width)
    }

    /// Returns the value required by allele `bit`; `None` for a don't-care, or for a bit of a number
    /// with a range.
    pub fn allele(&self, bit: usize) -> Option<bool> {
        let at = |words: &Words| words[bit / 64] >> (bit % 64) & 1 == 1;
        at(&self.care).then(|| at(&self.value))
    }

    /// Returns the alleles from `bit` to the end of its machine word: a mask of the specified
    /// alleles, and their values.
    pub(super) fn words_of(&self, bit: usize) -> [u64; 2] {
        [self.care, self.value].map(|words| words[bit / 64] >> (bit % 64))
    }

    /// Returns the number of alleles that are not don't-cares, plus one for each limit of a range.
    pub fn specificity(&self) -> usize {
        let alleles = self.care.iter().map(|word| word.count_ones() as usize);
        alleles.sum::<usize>() + self.ranges.specificity()
    }

    /// Returns true if the condition matches a percept of the same width.
    pub fn matches(&self, percept: &Percept) -> bool {
        let words = self.value.iter().zip(&self.care).zip(percept.words());
        words.fold(0, |wrong, ((value, care), p)| wrong | ((value ^ p) & care)) == 0
            && self.ranges.match_all(percept)
    }

    /// Returns true if this condition matches everything that `other` matches, and more. Alleles are
    /// compared with alleles, and ranges with ranges.
    pub fn is_more_general_than(&self, other: &Self) -> bool {
        (self.care != other.care || self.ranges != other.ranges)
            && self.ranges.contain(&other.ranges)
            && (0..PERCEPT_WORDS).all(|word| {
                self.care[word] & !other.care[word] == 0
                    && (self.value[word] ^ other.value[word]) & self.care[word] == 0
            })
    }

    /// Two-point crossover: exchanges the alleles `from..to`, and the rest of a number with a range.
    pub fn exchange(&mut self, other: &mut Self, from: usize, to: usize) {
        let mut bits = from..to;
        if !self.ranges.is_empty() || !other.ranges.is_empty() {
            bits = self.whole_numbers(other, bits);
            self.ranges.exchange(&mut other.ranges, &bits);
        }
        for word in 0..PERCEPT_WORDS {
            let mask = bits_between(word, bits.start, bits.end);
            exchange_bits(&mut self.value[word], &mut other.value[word], mask);
            exchange_bits(&mut self.care[word], &mut other.care[word], mask);
        }
    }

    /// Returns these bits, and the other bits of each number that they cut and that has a range here
    /// or in `other`.
    fn whole_numbers(&self, other: &Self, mut bits: Range<usize>) -> Range<usize> {
        loop {
            let ranges = self.ranges().chain(other.ranges()).map(NumberRange::bits);
            let cut = ranges.filter(|number| ranges::overlap(number, &bits));
            let whole = cut.fold(bits.clone(), |bits, number| {
                bits.start.min(number.start)..bits.end.max(number.end)
            });
            if whole == bits {
                return bits;
            }
            bits = whole;
        }
    }

    /// Niche mutation: flips each allele with probability `mu` between don't-care and the percept's
    /// value, so the condition still matches the percept. A flip in a number with a range removes the
    /// range.
    pub fn mutate(&mut self, percept: &Percept, mu: f64, stream: &mut Stream) {
        for bit in 0..self.width() {
            if !stream.chance(mu) {
            } else if let Some(range) = self.ranges.at(bit).copied() {
                self.ranges.remove(&range.bits());
            } else if self.allele(bit).is_some() {
                self.set_dont_care(bit);
            } else {
                self.set(bit, percept.bit(bit));
            }
        }
    }

    fn set(&mut self, bit: usize, value: bool) {
        self.care[bit / 64] |= 1 << (bit % 64);
        self.value[bit / 64] |= u64::from(value) << (bit % 64);
    }

    fn set_dont_care(&mut self, bit: usize) {
        self.care[bit / 64] &= !(1 << (bit % 64));
        self.value[bit / 64] &= !(1 << (bit % 64));
    }
}

/// Returns the bits of machine word number `word` that belong to alleles `from..to`.
fn bits_between(word: usize, from: usize, to: usize) -> u64 {
    let below = |end: usize| match end.saturating_sub(64 * word) {
        bits @ 0..64 => (1 << bits) - 1,
        _ => u64::MAX,
    };
    below(to) & !below(from)
}

fn exchange_bits(a: &mut u64, b: &mut u64, mask: u64) {
    let difference = (*a ^ *b) & mask;
    *a ^= difference;
    *b ^= difference;
}

/// Hashes only the words in use. The others are zero in all conditions of the same width.
impl Hash for Condition {
    fn hash<H: Hasher>(&self, state: &mut H) {
        let words = self.value.iter().zip(&self.care);
        for (value, care) in words.take(self.width().div_ceil(64)) {
            state.write_u64(*value);
            state.write_u64(*care);
        }
        if !self.ranges.is_empty() {
            self.ranges.hash(state);
        }
    }
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (0..self.width()).try_for_each(|bit| match (self.ranges.at(bit), self.allele(bit)) {
            (Some(range), _) if range.bits().start == bit => write!(f, "{range}"),
            (Some(_), _) => Ok(()),
            (None, None) => f.write_str("#"),
            (None, Some(false)) => f.write_str("0"),
            (None, Some(true)) => f.write_str("1"),
        })
    }
}

impl fmt::Debug for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Condition({self})")
    }
}

/// A text that is not a valid condition.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{0}` is not a condition: expected at most {MAX_PERCEPT_BITS} characters, each 0, 1 or # (or the range \
     of a number, such as [4-7:4])"
)]
pub struct ConditionError(String);

impl FromStr for Condition {
    type Err = ConditionError;

    fn from_str(text: &str) -> Result<Self, ConditionError> {
        let error = || ConditionError(text.chars().take(MAX_PERCEPT_BITS + 1).collect());
        let mut condition = Self::anything(0);
        let (mut rest, mut bit) = (text, 0);
        while let Some(symbol) = rest.chars().next().filter(|_| bit < MAX_PERCEPT_BITS) {
            rest = &rest[symbol.len_utf8()..];
            match symbol {
                '0' | '1' => condition.set(bit, symbol == '1'),
                '#' => {}
                '[' => {
                    let (range, after) = ranges::read(rest, bit).ok_or_else(error)?;
                    if !condition.ranges.set(range) {
                        return Err(error());
                    }
                    (rest, bit) = (after, range.bits().end - 1);
                }
                _ => return Err(error()),
            }
            bit += 1;
        }
        condition.width = bit as u16;
        (rest.is_empty() && bit <= MAX_PERCEPT_BITS)
            .then_some(condition)
            .ok_or_else(error)
    }
}

impl TryFrom<String> for Condition {
    type Error = ConditionError;

    fn try_from(text: String) -> Result<Self, ConditionError> {
        text.parse()
    }
}

impl From<Condition> for String {
    fn from(condition: Condition) -> Self {
        condition.to_string()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn condition(text: &str) -> Condition {
        text.parse().unwrap()
    }

    #[test]
    fn a_dont_care_matches_both_values_and_a_bit_only_its_own() {
        let rule = condition("0#1");
        let matched: Vec<bool> = ["001", "011", "000", "101"]
            .map(|percept| rule.matches(&percept.parse().unwrap()))
            .to_vec();
        assert_eq!(matched, [true, true, false, false]);
    }

    #[test]
    fn more_general_means_a_proper_superset() {
        assert!(condition("0##").is_more_general_than(&condition("0#1")));
        assert!(!condition("0#1").is_more_general_than(&condition("0#1")));
        assert!(!condition("1##").is_more_general_than(&condition("0#1")));
        assert!(!condition("0#1").is_more_general_than(&condition("0##")));
    }

    #[test]
    fn two_point_crossover_exchanges_the_alleles_between_the_points() {
        let (mut a, mut b) = (condition("00000"), condition("1##11"));
        a.exchange(&mut b, 1, 4);
        assert_eq!(
            (a.to_string(), b.to_string()),
            ("0##10".into(), "10001".into())
        );
    }

    #[test]
    fn crossover_across_machine_words_exchanges_nothing_else() {
        let (mut a, mut b) = (condition(&"0".repeat(320)), condition(&"1".repeat(320)));
        a.exchange(&mut b, 60, 200);
        let expected = ["0".repeat(60), "1".repeat(140), "0".repeat(120)].concat();
        assert_eq!(a.to_string(), expected);
    }

    #[test]
    fn certain_mutation_flips_every_allele_within_the_niche() {
        let percept = "0110".parse().unwrap();
        let mut rule = condition("0##0");
        rule.mutate(&percept, 1.0, &mut Stream::new(1, 0_u64));
        assert_eq!(rule.to_string(), "#11#");
    }

    #[test]
    fn covering_matches_the_percept_with_the_given_share_of_dont_cares() {
        let mut stream = Stream::new(1, 0_u64);
        let percept: Percept = "01".repeat(128).parse().unwrap();
        let cover = Condition::covering(&percept, 0.25, &mut stream);
        assert!(cover.matches(&percept));
        assert!((170..215).contains(&cover.specificity()), "{cover}");
        assert_eq!(
            Condition::covering(&percept, 0.0, &mut stream),
            Condition::exactly(&percept)
        );
    }

    proptest! {
        #[test]
        fn a_condition_prints_as_it_was_read(text in "[01#]{0,320}|[01#]{0,9}\\[[0-3]-[4-6]:3\\][01#]{0,9}") {
            prop_assert_eq!(condition(&text).to_string(), text);
        }

        #[test]
        fn mutation_and_crossover_within_a_niche_keep_it_matched(
            bits in "[01]{1,320}", seed in any::<u64>(), from in 0_usize..321, len in 0_usize..321,
        ) {
            let percept: Percept = bits.parse().unwrap();
            let mut stream = Stream::new(seed, 0_u64);
            let mut a = Condition::covering(&percept, 0.5, &mut stream);
            let mut b = Condition::covering(&percept, 0.5, &mut stream);
            a.exchange(&mut b, from.min(bits.len()), (from + len).min(bits.len()));
            a.mutate(&percept, 0.3, &mut stream);
            prop_assert!(a.matches(&percept) && b.matches(&percept), "{} {}", a, b);
        }
    }
}
