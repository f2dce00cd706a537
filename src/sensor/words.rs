//! What a condition demands of a percept, in words.

use super::{Sensor, lidar, neighbours, position};
use crate::world::{Direction, Maze};

/// The value that a condition demands of an allele; `None` for a don't-care.
pub type Alleles<'a> = &'a dyn Fn(usize) -> Option<bool>;

/// What a condition demands that demands nothing.
pub const ANYTHING: &str = "anything";

/// Names of the eight neighbours of a robot that faces the way of its action.
const FACING: [&str; 8] = [
    "ahead",
    "ahead right",
    "right",
    "behind right",
    "behind",
    "behind left",
    "left",
    "ahead left",
];

impl Sensor {
    /// What a condition demands, such as `north wall, east free`; `anything` if nothing.
    pub fn words(self, maze: &Maze, alleles: Alleles<'_>) -> String {
        self.phrase(Direction::CLOCKWISE.map(Direction::name), maze, alleles)
    }

    /// The same of a condition on a percept that was turned the way of the action, such as
    /// `ahead wall`.
    pub fn words_facing(self, maze: &Maze, alleles: Alleles<'_>) -> String {
        self.phrase(FACING, maze, alleles)
    }

    fn phrase(self, names: [&str; 8], maze: &Maze, alleles: Alleles<'_>) -> String {
        let behind_ring = |at| alleles(at + neighbours::WIDTH);
        let words = match self {
            Self::Neighbours => around(names, alleles),
            Self::Position => place(maze, alleles),
            Self::NeighboursPosition => {
                let mut words = around(names, alleles);
                words.extend(place(maze, &behind_ring));
                words
            }
            Self::Lidar => seen(names, alleles),
            Self::LidarRanges => ranges(names, alleles),
            Self::LidarBeams => beams(names, alleles),
            Self::LidarPosition => {
                let mut words = seen(names, alleles);
                words.extend(place(maze, &behind_ring));
                words
            }
        };
        match words.is_empty() {
            true => ANYTHING.to_owned(),
            false => words.join(", "),
        }
    }
}

/// Two alleles for each cell: goal or not, and barred (wall or goal) or not.
fn around(names: [&str; 8], alleles: Alleles<'_>) -> Vec<String> {
    let word = |(at, name): (usize, &str)| {
        let state = match [alleles(2 * at), alleles(2 * at + 1)] {
            [None, None] => return None,
            [Some(true), _] => "goal",
            [Some(false), None] => "no goal",
            [Some(false), Some(true)] => "wall",
            [None, Some(true)] => "wall or goal",
            [_, Some(false)] => "free",
        };
        Some(format!("{name} {state}"))
    };
    names.into_iter().enumerate().filter_map(word).collect()
}

/// Two alleles for each cell, of which only the second one can differ.
fn seen(names: [&str; 8], alleles: Alleles<'_>) -> Vec<String> {
    let word = |(at, name): (usize, &str)| {
        let state = match alleles(2 * at + 1)? {
            true => "wall",
            false => "free",
        };
        Some(format!("{name} {state}"))
    };
    names.into_iter().enumerate().filter_map(word).collect()
}

/// How far the main directions are free, and the diagonals.
fn ranges(names: [&str; 8], alleles: Alleles<'_>) -> Vec<String> {
    let of_quarter = |quarter: usize| {
        let (main, diagonal) = (names[2 * quarter], names[2 * quarter + 1]);
        let first = quarter * (lidar::FARTHEST + 1);
        let far = (1..=lidar::FARTHEST).filter_map(move |far| {
            let at_least = alleles(first + far - 1)?;
            Some(match (at_least, far) {
                (true, 1) => format!("{main} free"),
                (true, _) => format!("{main} {far} cells free"),
                (false, 1) => format!("{main} wall"),
                (false, _) => format!("{main} wall within {far} cells"),
            })
        });
        let beside = alleles(first + lidar::FARTHEST)
            .map(|free| format!("{diagonal} {}", if free { "free" } else { "wall" }));
        far.chain(beside)
    };
    (0..4).flat_map(of_quarter).collect()
}

/// The bits of the beams.
fn beams(names: [&str; 8], alleles: Alleles<'_>) -> Vec<String> {
    let word = |beam: usize| {
        let first = beam * lidar::BEAM_BITS;
        let letter = |at| alleles(at).map_or('#', |bit| if bit { '1' } else { '0' });
        let bits: String = (first..first + lidar::BEAM_BITS).map(letter).collect();
        let (name, next) = (names[beam / 2], names[(beam / 2 + 1) % 8]);
        let demands = bits.contains(['0', '1']);
        demands.then(|| match beam.is_multiple_of(2) {
            true => format!("{name} range {bits}"),
            false => format!("{name} to {next} range {bits}"),
        })
    };
    (0..16).filter_map(word).collect()
}

/// The bits of column and row.
fn place(maze: &Maze, alleles: Alleles<'_>) -> Vec<String> {
    let of_col = position::col_width(maze);
    let bits = |range: std::ops::Range<usize>| {
        let letter = |at| alleles(at).map_or('#', |bit| if bit { '1' } else { '0' });
        range.map(letter).collect::<String>()
    };
    let parts = [
        ("column", bits(0..of_col)),
        ("row", bits(of_col..position::width(maze))),
    ];
    let demanding = parts
        .into_iter()
        .filter(|(_, bits)| bits.contains(['0', '1']));
    let words = demanding.map(|(name, bits)| format!("{name} {bits}"));
    words.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn maze() -> Maze {
        let text = br######"{"rows": ["#####", "#S.G#", "#####"]}"######;
        Maze::from_json(text, "corridor.json").unwrap()
    }

    fn allele(condition: &str) -> impl Fn(usize) -> Option<bool> {
        move |at| match condition.as_bytes()[at] {
            b'#' => None,
            bit => Some(bit == b'1'),
        }
    }

    #[test]
    fn two_alleles_say_what_lies_in_a_direction() {
        let alleles = allele("01#0#10#1#00##11");
        let words = Sensor::Neighbours.words(&maze(), &alleles);
        assert_eq!(
            words,
            "north wall, north-east free, east wall or goal, south-east no goal, south goal, \
             south-west free, north-west goal"
        );
        let alleles = allele("01##############");
        assert_eq!(
            Sensor::Neighbours.words_facing(&maze(), &alleles),
            "ahead wall"
        );
    }

    #[test]
    fn dont_cares_demand_nothing() {
        let alleles = |_| None;
        for sensor in Sensor::ALL {
            assert_eq!(sensor.words(&maze(), &alleles), "anything");
        }
    }

    #[test]
    fn a_lidar_sees_walls_and_how_far_it_is_free() {
        let alleles = allele("01#0############");
        let words = Sensor::Lidar.words(&maze(), &alleles);
        assert_eq!(words, "north wall, north-east free");
        let alleles = allele("#1##0###0#0####1");
        let words = Sensor::LidarRanges.words(&maze(), &alleles);
        assert_eq!(
            words,
            "north 2 cells free, east wall, south wall, south wall within 3 cells, north-west free"
        );
        let alleles = |at| (at == 0 || at == 5).then_some(true);
        let words = Sensor::LidarBeams.words(&maze(), &alleles);
        assert_eq!(words, "north range 1##, north to north-east range ##1");
    }

    #[test]
    fn positions_are_bits_of_column_and_row() {
        assert_eq!(
            Sensor::Position.words(&maze(), &allele("01###")),
            "column 01#"
        );
        assert_eq!(
            Sensor::Position.words(&maze(), &allele("1###1")),
            "column 1##, row #1"
        );
        let alleles = allele("01##############1####");
        let words = Sensor::NeighboursPosition.words(&maze(), &alleles);
        assert_eq!(words, "north wall, column 1##");
    }
}
