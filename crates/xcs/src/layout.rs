//! The features that conditions of guided covering may require of a percept.

use std::ops::Range;

use crate::condition::Condition;
use crate::percept::Percept;
use crate::ranges::{self, NumberRange};

/// The binary numbers in a percept, highest bit first. Conditions of guided covering require
/// ranges of these numbers, and values of all other bits.
///
/// Each feature is true or false in a percept. A feature is a bit outside of the numbers, or the
/// statement that a number is greater than a limit.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Layout {
    numbers: Vec<NumberRange>,
}

/// A feature of a percept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Feature {
    /// A bit outside of the numbers, or any bit that is not a feature.
    Bit(usize),
    /// The number in this place is greater than the limit.
    Above(usize, u16),
}

impl Layout {
    /// Creates the layout of percepts with at most two numbers, of at most 16 bits each. Empty
    /// numbers are ignored. Returns `None` if there are more, if they are wider, or if they overlap.
    pub fn with_numbers(bits: impl IntoIterator<Item = Range<usize>>) -> Option<Self> {
        let bits = bits.into_iter().filter(|bits| !bits.is_empty());
        let numbers: Vec<NumberRange> = bits.map(NumberRange::all).collect::<Option<_>>()?;
        let apart = numbers.is_sorted_by(|a, b| a.bits().end <= b.bits().start);
        (apart && numbers.len() <= ranges::MOST).then_some(Self { numbers })
    }

    /// Returns true if each range of a condition is of a number.
    pub fn fits(&self, condition: &Condition) -> bool {
        let is_number = |bits| self.numbers.iter().any(|all| all.bits() == bits);
        condition.ranges().all(|range| is_number(range.bits()))
    }

    /// Returns the parts of percepts of `width` bits: each bit outside of the numbers, and the first bit
    /// of each number.
    pub fn parts(&self, width: usize) -> Vec<usize> {
        let begins = |&bit: &usize| {
            self.number_at(bit)
                .is_none_or(|all| all.bits().start == bit)
        };
        (0..width).filter(begins).collect()
    }

    /// Returns the condition that requires the percept's values of these [`parts`](Self::parts).
    pub fn requiring_parts(
        &self,
        percept: &Percept,
        parts: impl IntoIterator<Item = usize>,
    ) -> Condition {
        let general = Condition::anything(percept.width());
        parts.into_iter().fold(general, |condition, part| {
            let Some(all) = self.number_at(part) else {
                return condition.demanding(part, percept.bit(part));
            };
            let number = ranges::number(percept, all.bits());
            let exact = all.between(number, number);
            exact.map_or(condition, |exact| condition.within(exact))
        })
    }

    /// Returns the number that contains a bit.
    fn number_at(&self, bit: usize) -> Option<&NumberRange> {
        self.numbers.iter().find(|all| all.bits().contains(&bit))
    }

    /// Returns the place of a feature among all features of percepts of `width` bits.
    pub(super) fn place(&self, feature: Feature, width: usize) -> usize {
        match feature {
            Feature::Bit(bit) => bit,
            Feature::Above(number, limit) => {
                let before = self.numbers[..number].iter();
                let limits: usize = before.map(|all| usize::from(all.limits()[1])).sum();
                width + limits + usize::from(limit)
            }
        }
    }

    /// Returns the features of percepts of `width` bits, in order.
    pub(super) fn features(&self, width: usize) -> impl Iterator<Item = Feature> + '_ {
        let bits = (0..width).filter(|&bit| self.number_at(bit).is_none());
        let numbers = self.numbers.iter().enumerate();
        let limits = numbers.flat_map(|(number, all)| {
            (0..all.limits()[1]).map(move |limit| Feature::Above(number, limit))
        });
        bits.map(Feature::Bit).chain(limits)
    }

    /// Returns the features that are true in a percept.
    pub(super) fn true_in<'a>(
        &'a self,
        percept: &'a Percept,
    ) -> impl Iterator<Item = Feature> + 'a {
        let bits = (0..percept.width()).filter(|&bit| percept.bit(bit));
        let numbers = self.numbers.iter().enumerate();
        let limits = numbers.flat_map(|(place, all)| {
            let number = ranges::number(percept, all.bits());
            (0..number).map(move |limit| Feature::Above(place, limit))
        });
        bits.map(Feature::Bit).chain(limits)
    }

    /// Returns the value of a number in a percept.
    pub(super) fn number(&self, percept: &Percept, number: usize) -> u16 {
        ranges::number(percept, self.numbers[number].bits())
    }

    /// Returns true if a feature is true in a percept.
    pub(super) fn is_true(&self, feature: Feature, percept: &Percept) -> bool {
        match feature {
            Feature::Bit(bit) => percept.bit(bit),
            Feature::Above(number, limit) => {
                ranges::number(percept, self.numbers[number].bits()) > limit
            }
        }
    }

    /// Returns true if a condition matches percepts in which a feature is true, and others.
    fn is_open(&self, feature: Feature, condition: &Condition) -> bool {
        match feature {
            Feature::Bit(bit) => condition.allele(bit).is_none(),
            Feature::Above(number, limit) => {
                let [least, most] = self.range_in(condition, &self.numbers[number]).limits();
                (least..most).contains(&limit)
            }
        }
    }

    /// Returns the condition with a value required of one more feature, which must be open.
    fn requiring(&self, condition: Condition, feature: Feature, value: bool) -> Condition {
        let (number, limit) = match feature {
            Feature::Bit(bit) => return condition.demanding(bit, value),
            Feature::Above(number, limit) => (number, limit),
        };
        let range = self.range_in(&condition, &self.numbers[number]);
        let [least, most] = range.limits();
        let narrower = match value {
            true => range.between(limit + 1, most),
            false => range.between(least, limit),
        };
        narrower.map_or(condition, |range| condition.within(range))
    }

    /// Returns the condition that requires the percept's values of these features.
    pub(super) fn condition(
        &self,
        percept: &Percept,
        features: impl IntoIterator<Item = Feature>,
    ) -> Condition {
        let general = Condition::anything(percept.width());
        features.into_iter().fold(general, |condition, feature| {
            match self.is_open(feature, &condition) {
                true => self.requiring(condition, feature, self.is_true(feature, percept)),
                false => condition,
            }
        })
    }

    /// Returns the range that a condition requires of a number: all numbers if none is required.
    fn range_in(&self, condition: &Condition, all: &NumberRange) -> NumberRange {
        let own = condition.ranges().find(|range| range.bits() == all.bits());
        own.copied().unwrap_or(*all)
    }
}
