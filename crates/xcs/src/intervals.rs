//! Interval conditions on real-valued percepts (XCSR).

use std::fmt;
use std::hash::{Hash, Hasher};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::action::WIDE_ACTIONS;
use crate::bounds::OutOfRange;
use crate::params::Params;
use crate::random::Stream;
use crate::representation::{Index, Representation};
use crate::settings;

settings! {
    section "xcsr";

    /// Parameters of interval conditions, in units of the range 0 to 1 of an attribute.
    pub struct IntervalSettings {
        /// s0: in covering, each bound lies at most this far from the percept (Wilson 2000).
        /// With many attributes and a small spread, hardly any rule matches twice; above 1, more and more
        /// attributes begin as don't-cares.
        s0: f64 = 1.0, in 0.0..=1e3;
        /// m: mutation moves a bound at most this far (Wilson 2000).
        m: f64 = 0.1, in 0.0..=1.0;
    }
}

/// A real-valued percept: any number of attributes, each from 0 to 1. Clones share the values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(into = "Vec<f64>", try_from = "Vec<f64>")]
pub struct RealPercept(Arc<[f64]>);

/// A value of a percept that is not a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("attribute {attribute} of the percept is not a number")]
pub struct NotANumber {
    /// The number of the attribute, from 0.
    pub attribute: usize,
}

impl RealPercept {
    /// Creates a percept. Values below 0 become 0, and values above 1 become 1.
    ///
    /// # Errors
    /// Returns an error if a value is NaN.
    pub fn new(values: &[f64]) -> Result<Self, NotANumber> {
        match values.iter().position(|value| value.is_nan()) {
            Some(attribute) => Err(NotANumber { attribute }),
            None => Ok(Self(values.iter().map(|&value| clamped(value)).collect())),
        }
    }

    /// Returns the attributes, each from 0 to 1.
    pub fn values(&self) -> &[f64] {
        &self.0
    }
}

impl From<RealPercept> for Vec<f64> {
    fn from(percept: RealPercept) -> Self {
        percept.0.to_vec()
    }
}

impl TryFrom<Vec<f64>> for RealPercept {
    type Error = NotANumber;

    fn try_from(values: Vec<f64>) -> Result<Self, NotANumber> {
        Self::new(&values)
    }
}

/// Returns the value clamped to 0 to 1. -0 becomes 0, so that equal values have equal bits.
fn clamped(value: f64) -> f64 {
    value.clamp(0.0, 1.0) + 0.0
}

/// A condition on real-valued percepts: for each attribute an interval `[lower, upper]`.
///
/// A condition matches a percept if each attribute lies within its interval, including the bounds.
/// Bounds are ordered and range from 0 to 1, so `[0, 1]` is a don't-care.
///
/// XCSR: S. W. Wilson, "Get real! XCS with continuous-valued inputs" (2000), with the ordered-bound
/// representation of C. Stone and L. Bull, "For real! XCS with continuous-valued inputs" (2003).
#[derive(Clone, Serialize, Deserialize)]
#[serde(into = "Vec<[f64; 2]>", try_from = "Vec<[f64; 2]>")]
pub struct Intervals(Box<[[f64; 2]]>);

/// Bounds that are not an interval within 0 to 1.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "[{lower}, {upper}] of attribute {attribute} is not an interval: expected 0 <= lower <= upper <= 1"
)]
pub struct IntervalError {
    /// The number of the attribute, from 0.
    pub attribute: usize,
    /// The lower bound.
    pub lower: f64,
    /// The upper bound.
    pub upper: f64,
}

impl Intervals {
    /// Creates a condition from `[lower, upper]` for each attribute.
    ///
    /// # Errors
    /// Returns an error if bounds are not ordered, not a number, or outside of 0 to 1.
    pub fn new(bounds: &[[f64; 2]]) -> Result<Self, IntervalError> {
        for (attribute, &[lower, upper]) in bounds.iter().enumerate() {
            if !(0.0 <= lower && lower <= upper && upper <= 1.0) {
                return Err(IntervalError {
                    attribute,
                    lower,
                    upper,
                });
            }
        }
        Ok(Self(bounds.iter().map(|pair| pair.map(clamped)).collect()))
    }

    /// Returns `[lower, upper]` of each attribute.
    pub fn bounds(&self) -> &[[f64; 2]] {
        &self.0
    }
}

impl Representation for Intervals {
    type Percept = RealPercept;
    type Index = IntervalIndex;
    type Settings = IntervalSettings;
    const MAX_ACTIONS: usize = WIDE_ACTIONS;

    fn check(settings: &IntervalSettings) -> Result<(), OutOfRange> {
        settings.check()
    }

    fn width(&self) -> usize {
        self.0.len()
    }

    fn matches(&self, percept: &RealPercept) -> bool {
        contain(&self.0, percept.values())
    }

    fn covering(
        percept: &RealPercept,
        _params: &Params,
        settings: &IntervalSettings,
        stream: &mut Stream,
    ) -> Self {
        let mut spread = || settings.s0 * stream.unit();
        let around = percept.values().iter();
        Self(
            around
                .map(|value| [clamped(value - spread()), clamped(value + spread())])
                .collect(),
        )
    }

    /// Moves each bound with probability mu by a uniform number from -m to m.
    fn mutate(
        &mut self,
        _percept: &RealPercept,
        params: &Params,
        settings: &IntervalSettings,
        stream: &mut Stream,
    ) {
        for pair in &mut self.0 {
            for bound in pair.iter_mut() {
                if stream.chance(params.mu) {
                    *bound = clamped(*bound + settings.m * (2.0 * stream.unit() - 1.0));
                }
            }
            if pair[0] > pair[1] {
                pair.swap(0, 1);
            }
        }
    }

    fn exchange(&mut self, other: &mut Self, from: usize, to: usize) {
        let to = to.min(self.0.len()).min(other.0.len());
        let from = from.min(to);
        self.0[from..to].swap_with_slice(&mut other.0[from..to]);
    }

    /// Returns the number of attributes minus the sum of the widths of their intervals.
    fn specificity(&self) -> f64 {
        self.0
            .iter()
            .map(|[lower, upper]| 1.0 - (upper - lower))
            .sum()
    }

    fn is_more_general_than(&self, other: &Self) -> bool {
        let contains = |([l, u], [lower, upper]): (&[f64; 2], &[f64; 2])| l <= lower && u >= upper;
        self != other && self.0.iter().zip(&other.0).all(contains)
    }
}

/// Returns true if each value lies within its interval.
fn contain(bounds: &[[f64; 2]], values: &[f64]) -> bool {
    let mut pairs = bounds.iter().zip(values);
    pairs.all(|([lower, upper], value)| lower <= value && value <= upper)
}

/// Equal bounds have equal bits, because no bound is -0.
impl PartialEq for Intervals {
    fn eq(&self, other: &Self) -> bool {
        self.0 == other.0
    }
}

/// Bounds are never NaN.
impl Eq for Intervals {}

impl Hash for Intervals {
    fn hash<H: Hasher>(&self, state: &mut H) {
        let bounds = self.0.as_flattened().iter();
        bounds.for_each(|bound| state.write_u64(bound.to_bits()));
    }
}

/// Formats as `[0.25, 0.50] # [0.00, 0.75]`, with `#` for a don't-care.
impl fmt::Display for Intervals {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (attribute, &[lower, upper]) in self.0.iter().enumerate() {
            f.write_str(if attribute == 0 { "" } else { " " })?;
            match [lower, upper] {
                [0.0, 1.0] => f.write_str("#")?,
                _ => write!(f, "[{lower:.2}, {upper:.2}]")?,
            }
        }
        Ok(())
    }
}

impl fmt::Debug for Intervals {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Intervals({self})")
    }
}

impl TryFrom<Vec<[f64; 2]>> for Intervals {
    type Error = IntervalError;

    fn try_from(bounds: Vec<[f64; 2]>) -> Result<Self, IntervalError> {
        Self::new(&bounds)
    }
}

impl From<Intervals> for Vec<[f64; 2]> {
    fn from(condition: Intervals) -> Self {
        condition.0.into_vec()
    }
}

/// The bounds of all conditions, stored contiguously.
#[derive(Debug, Clone, Default)]
pub struct IntervalIndex {
    bounds: Vec<[f64; 2]>,
    width: usize,
    conditions: usize,
}

impl Index<Intervals> for IntervalIndex {
    fn push(&mut self, condition: &Intervals) {
        if self.conditions == 0 {
            self.width = condition.0.len();
        }
        self.bounds.extend_from_slice(&condition.0);
        self.conditions += 1;
    }

    fn swap_remove(&mut self, position: usize) {
        self.conditions -= 1;
        let last = self.conditions * self.width;
        self.bounds.copy_within(last.., position * self.width);
        self.bounds.truncate(last);
    }

    fn for_each_match(&self, percept: &RealPercept, mut found: impl FnMut(usize)) {
        if self.width == 0 {
            return (0..self.conditions).for_each(found);
        }
        for (position, bounds) in self.bounds.chunks_exact(self.width).enumerate() {
            if contain(bounds, percept.values()) {
                found(position);
            }
        }
    }
}

#[cfg(test)]
mod tests;
