//! The demands of a condition on a context, by part: coordinates as limits, all else as bits.

use crate::agent::estimator::map::cell_counts::FURTHEST;
use crate::agent::estimator::map::state_map::MOST_PAYING;
use crate::agent::estimator::map::tracker::{COORDINATE_BITS, MAP_BITS, PERCEPT_BITS, STEP_BITS};
use xcs::Condition;

/// A part of a context.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// The percept.
    Percept,
    /// Number of cells east of the goal.
    X,
    /// Number of cells north of the goal.
    Y,
    /// The number of the map.
    Map,
    /// The rewards of the map that were collected.
    Collected,
    /// The last step: whether there was one, its action, its percept.
    Last,
    /// The step before the last.
    Before,
}

/// A demand on a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Demand {
    /// These bits have these values.
    Bits {
        /// Mask of the specified bits.
        care: u32,
        /// Their values.
        value: u32,
    },
    /// The coordinate is greater than this.
    Above(i16),
    /// The coordinate is at most this.
    AtMost(i16),
}

/// The parts in their order in a context.
const PARTS: [(Part, usize); 7] = [
    (Part::Percept, PERCEPT_BITS),
    (Part::X, COORDINATE_BITS),
    (Part::Y, COORDINATE_BITS),
    (Part::Map, MAP_BITS),
    (Part::Collected, MOST_PAYING),
    (Part::Last, STEP_BITS),
    (Part::Before, STEP_BITS),
];

/// Returns all demands of a condition on a context.
pub fn demands(condition: &Condition) -> Vec<(Part, Demand)> {
    let mut demands = Vec::new();
    let mut from = 0;
    for (part, width) in PARTS {
        let alleles = |value: bool| {
            let bits = 0..width;
            bits.filter(move |bit| condition.allele(from + bit) == Some(value))
        };
        let own = match part {
            Part::X | Part::Y => limits(alleles(true).max(), alleles(false).min()),
            _ => bits(alleles(true), alleles(false)),
        };
        demands.extend(own.into_iter().map(|demand| (part, demand)));
        from += width;
    }
    demands
}

/// Returns the limits of a coordinate from the position of its last one bit and its first zero bit.
fn limits(one: Option<usize>, zero: Option<usize>) -> Vec<Demand> {
    let limit = |bit: usize| bit as i16 - FURTHEST as i16;
    let above = one.map(|bit| Demand::Above(limit(bit)));
    let at_most = zero.map(|bit| Demand::AtMost(limit(bit)));
    above.into_iter().chain(at_most).collect()
}

fn bits(ones: impl Iterator<Item = usize>, zeros: impl Iterator<Item = usize>) -> Vec<Demand> {
    let mask =
        |bits: &mut dyn Iterator<Item = usize>| bits.fold(0, |mask, bit| mask | 1_u32 << bit);
    let value = mask(&mut { ones });
    let care = value | mask(&mut { zeros });
    match care {
        0 => Vec::new(),
        _ => vec![Demand::Bits { care, value }],
    }
}
