//! The exported policy as one serialised model, which JSON shows and which templates read.

use serde::Serialize;

use super::Provenance;
use super::policy::{Policy, Size};
use super::provenance::{Facts, Robot};
use crate::disk;
use crate::world::{Cell, Direction, Maze};
use xcs::{Action, Condition};

/// The policy as data.
#[derive(Serialize)]
pub(super) struct Model<'a> {
    origin: &'a Facts,
    /// The number of inputs in which the export was compared with the greedy choice of the run.
    compared: String,
    /// The meaning of each bit of a percept when it is 1.
    bits: Vec<String>,
    actions: Vec<String>,
    rules: Vec<Rule>,
}

/// A rule.
#[derive(Serialize)]
struct Rule {
    condition: String,
    action: usize,
    weight: u32,
    value: u32,
    #[serde(rename = "if")]
    words: String,
    go: String,
}

impl<'a> Model<'a> {
    pub fn new(policy: &'a Policy, provenance: &'a Provenance) -> Self {
        let rules = policy.votes().iter().map(|vote| Rule {
            condition: vote.condition.to_string(),
            action: vote.action.index(),
            weight: vote.weight,
            value: vote.value,
            words: provenance.words(&vote.condition),
            go: provenance.action(vote.action),
        });
        let bits = 0..policy.width();
        let actions = Action::all(policy.actions());
        Self {
            origin: &provenance.facts,
            compared: policy.compared(),
            bits: bits.map(|bit| provenance.bit(bit)).collect(),
            actions: actions.map(|action| provenance.action(action)).collect(),
            rules: rules.collect(),
        }
    }

    /// Returns a JSON document.
    pub fn json(&self) -> String {
        disk::json(self)
    }

    /// Returns a CSV table with a row for each rule.
    pub fn csv(&self) -> String {
        let mut writer = csv::Writer::from_writer(Vec::new());
        for rule in &self.rules {
            writer.serialize(rule).expect("rules of texts and numbers");
        }
        let bytes = writer.into_inner().expect("a vector takes all");
        String::from_utf8(bytes).expect("texts and numbers")
    }
}

/// What templates of source code read.
#[derive(Serialize)]
pub(super) struct Source<'a> {
    #[serde(flatten)]
    model: Model<'a>,
    /// The origin as lines for a comment.
    origin_lines: Vec<String>,
    size: Size,
    /// For each rule its condition: a pair of numbers for each byte of a percept.
    conditions: Vec<Vec<Pair>>,
    /// For each rule the least and the greatest column and row.
    limits: Vec<[Pair; 2]>,
    /// For each rule its condition without ranges.
    ternary: Vec<String>,
    percept: PerceptBits,
    grid: Grid,
    places: Places,
    /// In a world from a map: for each row of cells the bits of the open moves.
    open: Option<Vec<Vec<u8>>>,
    clear_radius_m: Option<f64>,
    robot: Option<Robot>,
    /// True if the percept shows walls and no goals.
    shows_walls: bool,
}

/// Column and row of the start and of each goal.
#[derive(Serialize)]
struct Places {
    start: Option<[u16; 2]>,
    goals: Vec<[u16; 2]>,
}

/// A mask of demanded bits and their values, or the least and the greatest number, as literals
/// of all languages.
type Pair = [String; 2];

/// The layout of a percept.
#[derive(Serialize)]
struct PerceptBits {
    /// The meaning of each bit.
    bits: Vec<String>,
    bytes: usize,
    ring_bits: usize,
    column_bits: usize,
    row_bits: usize,
}

/// Up to here, a float of 32 bits is exact to 4 mm.
const MOST_IN_32_BITS_M: f64 = 65_536.0;

/// The grid of the world in the map frame.
#[derive(Serialize)]
struct Grid {
    cell_size_m: f64,
    columns: u16,
    rows: u16,
    wraps: bool,
    origin_x_m: f64,
    origin_y_m: f64,
    origin_cosine: f64,
    origin_sine: f64,
    /// True if 32 bits do not hold coordinates of the map frame to the centimetre.
    is_far: bool,
}

impl<'a> Source<'a> {
    pub fn new(policy: &'a Policy, provenance: &'a Provenance) -> Self {
        let percept = PerceptBits::new(policy, provenance);
        let votes = || policy.votes().iter();
        Self {
            model: Model::new(policy, provenance),
            limits: votes()
                .map(|vote| percept.limits(&vote.condition))
                .collect(),
            ternary: votes().map(|vote| ternary(&vote.condition)).collect(),
            origin_lines: provenance.lines(),
            size: policy.size(),
            conditions: votes()
                .map(|vote| percept_pairs(policy, &vote.condition))
                .collect(),
            percept,
            grid: Grid::new(&provenance.maze),
            places: Places::new(&provenance.maze),
            open: open_moves(&provenance.maze),
            clear_radius_m: provenance.maze.clear_radius_m(),
            robot: provenance.robot,
            shows_walls: provenance.sensor.is_sensed(),
        }
    }
}

impl PerceptBits {
    fn new(policy: &Policy, provenance: &Provenance) -> Self {
        let (maze, sensor) = (&provenance.maze, provenance.sensor);
        let width = policy.width();
        let [column_bits, row_bits] = sensor.place_bits(maze);
        Self {
            bits: (0..width).map(|bit| provenance.bit(bit)).collect(),
            bytes: width.div_ceil(8),
            ring_bits: sensor.width(maze) - column_bits - row_bits,
            column_bits,
            row_bits,
        }
    }

    /// Returns the least and the greatest column and row that a condition matches.
    fn limits(&self, condition: &Condition) -> [Pair; 2] {
        let rows = self.ring_bits + self.column_bits;
        [self.ring_bits..rows, rows..rows + self.row_bits].map(|bits| {
            let own = condition.ranges().find(|range| range.bits() == bits);
            let limits = own.map_or([0, u16::MAX], |range| range.limits());
            limits.map(|limit| limit.to_string())
        })
    }
}

impl Grid {
    fn new(maze: &Maze) -> Self {
        let corner = maze.origin();
        let extent_m = f64::from(maze.width().max(maze.height())) * maze.cell_size_m();
        Self {
            cell_size_m: maze.cell_size_m(),
            columns: maze.width(),
            rows: maze.height(),
            wraps: maze.wraps(),
            origin_x_m: corner.x_m,
            origin_y_m: corner.y_m,
            origin_cosine: libm::cos(corner.yaw_rad),
            origin_sine: libm::sin(corner.yaw_rad),
            is_far: corner.x_m.abs().max(corner.y_m.abs()) + extent_m > MOST_IN_32_BITS_M,
        }
    }
}

impl Places {
    fn new(maze: &Maze) -> Self {
        let place = |cell: Cell| [cell.col, cell.row];
        Self {
            start: maze.start().map(place),
            goals: maze.goals().iter().copied().map(place).collect(),
        }
    }
}

/// Returns for each row of cells the bits of the open moves, clockwise from north; `None` in a maze.
fn open_moves(maze: &Maze) -> Option<Vec<Vec<u8>>> {
    let bits = |cell: Cell| {
        let directions = (0_u8..).zip(Direction::CLOCKWISE);
        let is_open = |direction| !maze.is_wall(cell) && maze.is_open(cell, direction);
        directions.fold(0, |bits, (at, way)| bits | u8::from(is_open(way)) << at)
    };
    let row = |row| {
        (0..maze.width())
            .map(|col| bits(Cell { col, row }))
            .collect()
    };
    maze.is_from_map()
        .then(|| (0..maze.height()).map(row).collect())
}

/// Returns the bits that a condition demands, with `#` for all others.
fn ternary(condition: &Condition) -> String {
    let allele = |bit| {
        condition
            .allele(bit)
            .map_or('#', |one| if one { '1' } else { '0' })
    };
    (0..condition.width()).map(allele).collect()
}

/// Returns the demands of a condition on each byte of a percept.
fn percept_pairs(policy: &Policy, condition: &Condition) -> Vec<Pair> {
    let byte = |first: usize| {
        let bits = first..(first + 8).min(policy.width());
        let demands = bits.filter_map(|bit| Some((bit - first, condition.allele(bit)?)));
        let [mask, value] = demands.fold([0_u8; 2], |[mask, value], (bit, demanded)| {
            [mask | 1 << bit, value | u8::from(demanded) << bit]
        });
        masked(mask.into(), value.into())
    };
    (0..policy.width()).step_by(8).map(byte).collect()
}

fn masked(mask: u32, value: u32) -> Pair {
    [format!("{mask:#x}"), format!("{value:#x}")]
}
