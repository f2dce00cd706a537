//! Ranges of the binary numbers that a percept contains.

use std::fmt;
use std::ops::Range;

use crate::percept::Percept;

/// The largest number of ranges of a condition.
pub const MOST: usize = 2;
/// The widest number, in bits.
const WIDEST: usize = 16;

/// A range of a number that consecutive bits of a percept encode in binary, the highest bit first.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NumberRange {
    first: u16,
    /// 0 for an unused range.
    width: u16,
    least: u16,
    most: u16,
}

impl NumberRange {
    /// Returns the range of all numbers of these bits; `None` if there are none or too many bits.
    pub(super) fn all(bits: Range<usize>) -> Option<Self> {
        let width = bits.len();
        (1..=WIDEST).contains(&width).then(|| Self {
            first: bits.start as u16,
            width: width as u16,
            least: 0,
            most: u16::MAX >> (WIDEST - width),
        })
    }

    /// Returns the range from `least` to `most`; `None` if it is empty or leaves this range.
    pub(super) fn between(self, least: u16, most: u16) -> Option<Self> {
        let fits = self.least <= least && least <= most && most <= self.most;
        fits.then_some(Self {
            least,
            most,
            ..self
        })
    }

    /// Returns the bits of the number.
    pub fn bits(&self) -> Range<usize> {
        let first = usize::from(self.first);
        first..first + usize::from(self.width)
    }

    /// Returns the least and the greatest number in the range.
    pub fn limits(&self) -> [u16; 2] {
        [self.least, self.most]
    }

    /// Returns the number of limits that exclude any number: 0, 1 or 2.
    fn specificity(&self) -> usize {
        let widest = Self::all(self.bits()).map_or(0, |all| all.most);
        usize::from(self.least > 0) + usize::from(self.most < widest)
    }

    fn matches(&self, percept: &Percept) -> bool {
        (self.least..=self.most).contains(&number(percept, self.bits()))
    }

    fn contains(&self, other: &Self) -> bool {
        self.bits() == other.bits() && self.least <= other.least && other.most <= self.most
    }
}

/// Formats as `[4-7:4]`: a number of four bits from 4 to 7.
impl fmt::Display for NumberRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "[{}-{}:{}]", self.least, self.most, self.width)
    }
}

/// Returns the number that these bits encode, the highest bit first.
pub fn number(percept: &Percept, bits: Range<usize>) -> u16 {
    bits.fold(0, |number, bit| number << 1 | u16::from(percept.bit(bit)))
}

/// Reads `4-7:4]...` after the opening bracket. Returns the range, whose bits begin at `first`, and
/// the rest of the text.
pub(super) fn read(text: &str, first: usize) -> Option<(NumberRange, &str)> {
    let (inside, rest) = text.split_once(']')?;
    let (limits, width) = inside.split_once(':')?;
    let (least, most) = limits.split_once('-')?;
    let canonical = |text: &str| {
        let number: u16 = text.parse().ok()?;
        (number.to_string() == text).then_some(number)
    };
    let width = usize::from(canonical(width)?);
    let all = NumberRange::all(first..first + width)?;
    Some((all.between(canonical(least)?, canonical(most)?)?, rest))
}

/// The ranges of a condition, in the order of their bits, and unused ones after them. None of them
/// contains all numbers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Ranges([NumberRange; MOST]);

impl Ranges {
    pub fn iter(&self) -> impl Iterator<Item = &NumberRange> {
        self.0.iter().filter(|range| range.width > 0)
    }

    /// Returns the range of the number that contains a bit.
    pub fn at(&self, bit: usize) -> Option<&NumberRange> {
        self.iter().find(|range| range.bits().contains(&bit))
    }

    pub fn match_all(&self, percept: &Percept) -> bool {
        self.is_empty() || self.iter().all(|range| range.matches(percept))
    }

    /// Returns true if any percept outside of `other` cannot be within these ranges.
    pub fn contain(&self, other: &Self) -> bool {
        let held = |range: &NumberRange| other.iter().any(|other| range.contains(other));
        self.is_empty() || self.iter().all(held)
    }

    pub fn specificity(&self) -> usize {
        match self.is_empty() {
            true => 0,
            false => self.iter().map(NumberRange::specificity).sum(),
        }
    }

    pub fn is_empty(&self) -> bool {
        self.0[0].width == 0
    }

    /// Replaces the range of a number, or adds it. A range of all numbers is removed. Returns
    /// `false` if there is no room.
    pub fn set(&mut self, range: NumberRange) -> bool {
        self.remove(&range.bits());
        if range.specificity() == 0 {
            return true;
        }
        let all = self.iter().copied().chain([range]);
        let mut all: Vec<NumberRange> = all.collect();
        all.sort_unstable();
        let fits = all.len() <= MOST;
        if fits {
            self.put(&all);
        }
        fits
    }

    /// Removes the ranges with any of these bits.
    pub fn remove(&mut self, bits: &Range<usize>) {
        let apart = |range: &&NumberRange| !overlap(&range.bits(), bits);
        let left: Vec<NumberRange> = self.iter().filter(apart).copied().collect();
        self.put(&left);
    }

    fn put(&mut self, ranges: &[NumberRange]) {
        self.0 = Default::default();
        for (slot, range) in self.0.iter_mut().zip(ranges) {
            *slot = *range;
        }
    }

    /// Exchanges the ranges within these bits, which cut no range of either.
    pub fn exchange(&mut self, other: &mut Self, bits: &Range<usize>) {
        let (own, others) = (*self, *other);
        for (to, from) in [(self, others), (other, own)] {
            to.remove(bits);
            for range in from.iter().filter(|range| overlap(&range.bits(), bits)) {
                to.set(*range);
            }
        }
    }
}

/// Returns true if two ranges of bits have a bit in common.
pub(super) fn overlap(a: &Range<usize>, b: &Range<usize>) -> bool {
    a.start < b.end && b.start < a.end
}

#[cfg(test)]
mod tests {
    use crate::condition::Condition;
    use crate::random::Stream;

    fn condition(text: &str) -> Condition {
        text.parse().unwrap()
    }

    #[test]
    fn a_range_matches_the_numbers_between_its_limits() {
        let rule = condition("1[2-5:3]#");
        assert_eq!((rule.width(), rule.specificity()), (5, 3));
        let matched =
            (0..8).filter(|number| rule.matches(&format!("1{number:03b}0").parse().unwrap()));
        assert_eq!(matched.collect::<Vec<_>>(), [2, 3, 4, 5]);
        assert!(!rule.matches(&"00110".parse().unwrap()));
        assert!(condition("#[2-6:3]#").is_more_general_than(&rule));
        assert!(!condition("1[3-6:3]#").is_more_general_than(&rule));
        assert!(!rule.is_more_general_than(&rule));
        assert_eq!(condition("[0-7:3]").to_string(), "###");
    }

    #[test]
    fn damaged_ranges_are_refused() {
        for text in [
            "[2-5:3",
            "[5-2:3]",
            "[0-8:3]",
            "[02-5:3]",
            "[0-1:0]",
            "[0-1:17]",
            "[-:]",
            "]",
            "[1-2:2][1-2:2][1-2:2]",
        ] {
            assert!(text.parse::<Condition>().is_err(), "{text}");
        }
        let wide = format!("{}[1-2:2]", "#".repeat(319));
        assert!(wide.parse::<Condition>().is_err());
        assert_eq!(condition(&wide[1..]).width(), 320);
    }

    #[test]
    fn crossover_exchanges_whole_ranges() {
        let (mut a, mut b) = (condition("0[2-5:3]1"), condition("11011"));
        a.exchange(&mut b, 2, 5);
        assert_eq!(
            (a.to_string(), b.to_string()),
            ("01011".into(), "1[2-5:3]1".into())
        );
    }

    #[test]
    fn certain_mutation_removes_a_range() {
        let mut rule = condition("[2-5:3]#");
        rule.mutate(&"0111".parse().unwrap(), 1.0, &mut Stream::new(1, 0_u64));
        assert_eq!(rule.to_string(), "#111");
    }
}
