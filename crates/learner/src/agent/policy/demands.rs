//! The demands of a condition on a context, by part: coordinates as limits, all else as bits.

use std::ops::Range;

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
    demands_of(&|at| condition.allele(at))
}

/// The value that a condition requires of an allele; `None` for a don't-care.
type Alleles<'a> = &'a dyn Fn(usize) -> Option<bool>;

fn demands_of(alleles: Alleles<'_>) -> Vec<(Part, Demand)> {
    let mut demands = Vec::new();
    let mut from = 0;
    for (part, width) in PARTS {
        let required = |value: bool| {
            let bits = 0..width;
            bits.filter(move |bit| alleles(from + bit) == Some(value))
        };
        let own = match part {
            Part::X | Part::Y => limits(required(true).max(), required(false).min()),
            _ => bits(required(true), required(false)),
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

/// Describes what a condition requires beyond the current percept, such as `x > 2`. `seen` describes the
/// requirements on a percept, if there are any.
pub fn words(alleles: Alleles<'_>, seen: &dyn Fn(Alleles<'_>) -> Option<String>) -> Vec<String> {
    let mut words = Vec::new();
    for (part, demand) in demands_of(alleles) {
        let coordinate = if part == Part::X { "x" } else { "y" };
        match (part, demand) {
            (_, Demand::Above(limit)) => words.push(format!("{coordinate} > {limit}")),
            (_, Demand::AtMost(limit)) => words.push(format!("{coordinate} <= {limit}")),
            (Part::Percept | Part::X | Part::Y, _) => {}
            (Part::Map, _) => words.extend(pattern("map", demand, 0..MAP_BITS)),
            (Part::Collected, _) => {
                words.extend(pattern("rewards found", demand, 0..MOST_PAYING));
            }
            (Part::Last, _) => words.extend(step_words("last step", demand, seen)),
            (Part::Before, _) => words.extend(step_words("step before", demand, seen)),
        }
    }
    words
}

/// Describes the demands on an earlier step.
fn step_words(
    ago: &str,
    demand: Demand,
    seen: &dyn Fn(Alleles<'_>) -> Option<String>,
) -> Vec<String> {
    let taken = pattern(&format!("{ago} taken"), demand, 0..1);
    let action = pattern(&format!("{ago} action"), demand, 1..4);
    let percept = seen(&|at| demand.allele(4 + at));
    let percept = percept.map(|words| format!("{ago} saw {}", words.replace(", ", " and ")));
    [taken, action, percept].into_iter().flatten().collect()
}

/// Writes some bits of a part as a pattern; `None` if none is specified.
fn pattern(name: &str, demand: Demand, bits: Range<usize>) -> Option<String> {
    let state = |at| {
        demand
            .allele(at)
            .map_or('#', |bit| if bit { '1' } else { '0' })
    };
    let pattern: String = bits.map(state).collect();
    pattern
        .contains(['0', '1'])
        .then(|| format!("{name} {pattern}"))
}

impl Demand {
    /// Returns the value required of a bit; `None` for a don't-care or a limit.
    fn allele(self, at: usize) -> Option<bool> {
        match self {
            Self::Bits { care, value } => {
                (at < 32 && care >> at & 1 == 1).then(|| value >> at & 1 == 1)
            }
            Self::Above(_) | Self::AtMost(_) => None,
        }
    }
}
