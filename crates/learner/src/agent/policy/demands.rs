//! What a condition on a context demands, part by part: coordinates as limits, all else as bits.

use crate::agent::estimator::map::cell_counts::FURTHEST;
use crate::agent::estimator::map::state_map::MOST_PAYING;
use crate::agent::estimator::map::tracker::{COORDINATE_BITS, MAP_BITS, PERCEPT_BITS, STEP_BITS};
use xcs::Condition;

/// A part of a context.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// What is perceived.
    Percept,
    /// Cells to the east of the goal.
    X,
    /// Cells to the north of it.
    Y,
    /// The number of the map.
    Chart,
    /// Which rewards of the map were found.
    Eaten,
    /// The last step: was there one, its action, its percept.
    Last,
    /// The step before it.
    Before,
}

/// What is demanded of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Demand {
    /// These bits have these values.
    Bits {
        /// The bits that are looked at.
        care: u32,
        /// Their values.
        value: u32,
    },
    /// It is greater.
    Above(i16),
    /// It is not greater.
    AtMost(i16),
}

/// The parts in the order in which a context holds them.
const PARTS: [(Part, usize); 7] = [
    (Part::Percept, PERCEPT_BITS),
    (Part::X, COORDINATE_BITS),
    (Part::Y, COORDINATE_BITS),
    (Part::Chart, MAP_BITS),
    (Part::Eaten, MOST_PAYING),
    (Part::Last, STEP_BITS),
    (Part::Before, STEP_BITS),
];

/// All that a condition on a context demands.
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

/// The limits of a coordinate: it is greater than the last of the ones, and than none of the zeros.
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
