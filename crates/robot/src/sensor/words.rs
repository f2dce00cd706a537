//! Describes conditions on percepts in words.

use std::ops::Range;

use super::{Sensor, neighbours, position};
use crate::world::{Direction, Maze};
use xcs::{Condition, Percept};

/// What a condition requires of a percept.
pub trait Demands {
    /// Returns the value that is required at an allele; `None` for a don't-care.
    fn allele(&self, at: usize) -> Option<bool>;

    /// Returns the least and the greatest number that these bits may encode, if a range is required.
    fn range(&self, bits: Range<usize>) -> Option<[u16; 2]>;

    /// Returns the number of bits; `None` if it is unknown, so that earlier steps are not described.
    fn width(&self) -> Option<usize> {
        None
    }
}

impl Demands for Percept {
    fn allele(&self, at: usize) -> Option<bool> {
        (at < self.width()).then(|| self.bit(at))
    }

    fn range(&self, _: Range<usize>) -> Option<[u16; 2]> {
        None
    }

    fn width(&self) -> Option<usize> {
        Some(self.width())
    }
}

impl Demands for Condition {
    fn allele(&self, at: usize) -> Option<bool> {
        (at < self.width()).then(|| self.allele(at)).flatten()
    }

    fn range(&self, bits: Range<usize>) -> Option<[u16; 2]> {
        let own = self.ranges().find(|range| range.bits() == bits);
        own.map(|range| range.limits())
    }

    fn width(&self) -> Option<usize> {
        Some(self.width())
    }
}

impl<F: Fn(usize) -> Option<bool>> Demands for F {
    fn allele(&self, at: usize) -> Option<bool> {
        self(at)
    }

    fn range(&self, _: Range<usize>) -> Option<[u16; 2]> {
        None
    }
}

/// The demands of a condition. A function from alleles to their values demands no ranges.
pub type Alleles<'a> = &'a dyn Demands;

/// The words for a condition that matches everything.
pub const ANYTHING: &str = "anything";

impl Sensor {
    /// Describes a condition, for example `north wall, east free`. Returns `anything` if it matches
    /// everything.
    pub fn words(self, maze: &Maze, alleles: Alleles<'_>) -> String {
        self.demands(maze, alleles).join(", ")
    }

    /// Describes each demand of a condition. Returns `anything` if it matches everything.
    pub fn demands(self, maze: &Maze, alleles: Alleles<'_>) -> Vec<String> {
        let mut words = self.words_of_percept(maze, alleles);
        words.extend(self.words_of_history(maze, alleles));
        match words.is_empty() {
            true => vec![ANYTHING.to_owned()],
            false => words,
        }
    }

    /// Describes the percept without earlier steps.
    pub(super) fn words_of_percept(self, maze: &Maze, alleles: Alleles<'_>) -> Vec<String> {
        match self {
            Self::Neighbours => around(alleles),
            Self::Position => place(maze, 0, alleles),
            Self::NeighboursPosition => {
                let mut words = around(alleles);
                words.extend(place(maze, neighbours::WIDTH, alleles));
                words
            }
            Self::Lidar => seen(alleles),
            Self::LidarPosition => {
                let mut words = seen(alleles);
                words.extend(place(maze, neighbours::WIDTH, alleles));
                words
            }
        }
    }
}

/// Describes two alleles for each cell: goal or not, and barred (wall or goal) or not.
fn around(alleles: Alleles<'_>) -> Vec<String> {
    let word = |(at, direction): (usize, Direction)| {
        let state = match [alleles.allele(2 * at), alleles.allele(2 * at + 1)] {
            [None, None] => return None,
            // No cell shows `10`; a learner that perceives it treats the cell as free.
            [Some(true), Some(false)] => "free (observation error)",
            [Some(true), _] => "goal",
            [Some(false), None] => "no goal",
            [Some(false), Some(true)] => "wall",
            [None, Some(true)] => "wall or goal",
            [_, Some(false)] => "free",
        };
        Some(format!("{} {state}", direction.name()))
    };
    let around = Direction::CLOCKWISE.into_iter().enumerate();
    around.filter_map(word).collect()
}

/// Describes two alleles for each cell, of which only the second one can differ.
fn seen(alleles: Alleles<'_>) -> Vec<String> {
    let word = |(at, direction): (usize, Direction)| {
        let state = match alleles.allele(2 * at + 1)? {
            true => "wall",
            false => "free",
        };
        Some(format!("{} {state}", direction.name()))
    };
    let around = Direction::CLOCKWISE.into_iter().enumerate();
    around.filter_map(word).collect()
}

/// The largest number of ranges of columns or rows that are listed in full.
const MOST_RANGES: usize = 8;

/// Describes the columns and the rows that the bits from `first` on allow, as ranges.
fn place(maze: &Maze, first: usize, alleles: Alleles<'_>) -> Vec<String> {
    let (rows, end) = (
        first + position::col_width(maze),
        first + position::width(maze),
    );
    let column = coordinate(maze.width(), first..rows, alleles);
    let row = coordinate(maze.height(), rows..end, alleles);
    let column = column.map(|words| format!("column {words}"));
    column
        .into_iter()
        .chain(row.map(|words| format!("row {words}")))
        .collect()
}

/// Describes which of `count` columns or rows the binary digits at `bits` (highest first) allow,
/// for example `4 to 7`, or `at most 3 or 8` without a range. Returns `None` if all of them are
/// allowed.
fn coordinate(count: u16, bits: Range<usize>, alleles: Alleles<'_>) -> Option<String> {
    let of_width = 1_u32 << bits.len();
    let all = match alleles.range(bits.clone()) {
        Some(range) => vec![range.map(u32::from)],
        None => allowed_by_digits(bits, alleles),
    };
    let count = u32::from(count);
    let inside = all.iter().filter(|[first, _]| *first < count);
    let inside = inside.map(|&[first, last]| [first, last.min(count - 1)]);
    let inside: Vec<[u32; 2]> = inside.collect();
    match &inside[..] {
        // Only a percept with an observation error can have such a value.
        [] => Some(format!("{} (outside the world)", in_words(&all, of_width))),
        [[0, last]] if last + 1 == count => None,
        _ => Some(in_words(&inside, count)),
    }
}

/// Returns the numbers that the binary digits at `bits` (highest first) allow, as ascending ranges.
fn allowed_by_digits(bits: Range<usize>, alleles: Alleles<'_>) -> Vec<[u32; 2]> {
    let (mut free, mut ones) = (0, 0);
    for (at, bit) in bits.rev().enumerate() {
        match alleles.allele(bit) {
            None => free |= 1_u32 << at,
            Some(one) => ones |= u32::from(one) << at,
        }
    }
    ranges_of(free, ones)
}

/// Returns the numbers with these ones and any choice of the free digits, as ascending ranges.
fn ranges_of(free: u32, ones: u32) -> Vec<[u32; 2]> {
    // The lowest free digits form one range; each choice of the other free digits gives another
    // one.
    let within = (1 << free.trailing_ones()) - 1;
    let others = free & !within;
    let mut ranges = Vec::new();
    let mut chosen = 0_u32;
    loop {
        let first = ones | chosen;
        ranges.push([first, first + within]);
        chosen = chosen.wrapping_sub(others) & others;
        if chosen == 0 {
            return ranges;
        }
    }
}

/// Describes ranges of numbers below `count`.
fn in_words(ranges: &[[u32; 2]], count: u32) -> String {
    let word = |&[first, last]: &[u32; 2]| match (first, last) {
        _ if first == last => first.to_string(),
        (0, _) => format!("at most {last}"),
        _ if last + 1 == count => format!("at least {first}"),
        _ => format!("{first} to {last}"),
    };
    let words: Vec<String> = ranges.iter().map(word).collect();
    match &words[..] {
        [first, second, third, .., last] if words.len() > MOST_RANGES => {
            let numbers: u32 = ranges.iter().map(|[first, last]| last - first + 1).sum();
            format!("{first} or {second} or {third} or ... or {last} ({numbers} in all)")
        }
        _ => words.join(" or "),
    }
}

#[cfg(test)]
mod tests;
