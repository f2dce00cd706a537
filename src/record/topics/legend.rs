//! The legend of a scene's colours, south of the maze.

use foxglove::messages::SceneEntity;

use super::scene::{WORLD, entity, label, place};
use super::{estimate, percept, rays, trail};
use crate::picture::{NO_GOAL, SCALE};
use crate::sensor::Sensor;
use crate::world::Maze;

const WORDS: u32 = 0xcfd8e8;
/// The number of letters per row, and the width of a row as a multiple of the maze's width.
const LETTERS: f64 = 56.0;
const WIDE: f64 = 1.1;
/// The width of a letter and the row spacing, as multiples of a letter's height.
const LETTER: f64 = 0.55;
const ROW: f64 = 2.0;
/// The grid that words are aligned to, in cells. Such coordinates take few bytes.
const GRID: f64 = 1.0 / 8.0;
/// The maximum number of rows.
const ROWS: f64 = 2.0;
/// The number of spaces between two entries.
const GAP: usize = 2;

/// A text and its colour.
type Entry = (&'static str, u32);

/// Creates the legend of the arrows and the path.
pub(super) fn of_policy(maze: &Maze, time_ns: u64) -> SceneEntity {
    let [far, _, near] = SCALE;
    let entries = [
        ("arrow: best action, goal", WORDS),
        ("far", far),
        ("near", near),
        ("never", NO_GOAL),
        ("path", trail::FASTEST),
        ("hit", trail::HIT),
    ];
    row(maze, "legend", 0, &entries, time_ns)
}

/// Creates the legend of the overlays around the robot. `senses` is true if the robot estimates its
/// pose.
pub(in crate::record) fn of_robot(
    maze: &Maze,
    sensor: Sensor,
    [senses, beams]: [bool; 2],
    time_ns: u64,
) -> SceneEntity {
    let [free, wall, _] = percept::KINDS;
    let frames = [("frame: seen free", free), ("seen wall", wall)];
    let frames = frames
        .into_iter()
        .filter(|_| sensor.begins_with_neighbours());
    let believed = senses.then_some(("estimate", estimate::MARKER));
    let beams = (senses && beams).then_some(("lidar", rays::BEAM));
    let entries: Vec<Entry> = frames.chain(believed).chain(beams).collect();
    row(maze, "robot-legend", 1, &entries, time_ns)
}

/// Returns how far a legend extends south of the maze, in metres.
pub(in crate::record) fn height_m(maze: &Maze) -> f64 {
    (ROWS + 0.25) * ROW * letter_m(maze)
}

fn letter_m(maze: &Maze) -> f64 {
    WIDE * f64::from(maze.width()) * maze.cell_size_m() / (LETTER * LETTERS)
}

/// Creates row `number` of the legend, centred below the maze.
fn row(maze: &Maze, id: &str, number: u32, entries: &[Entry], time_ns: u64) -> SceneEntity {
    let high = letter_m(maze);
    let middle = f64::from(maze.width()) * maze.cell_size_m() / 2.0;
    let lengths = entries.iter().map(|(text, _)| text.len() + GAP);
    let all = lengths.sum::<usize>().saturating_sub(GAP);
    let grid_m = GRID * maze.cell_size_m();
    let mut before = 0;
    let mut row = entity(id, WORLD, time_ns);
    for &(text, rgb) in entries {
        let letters = before as f64 + (text.len() as f64 - all as f64) / 2.0;
        let along = middle + letters * LETTER * high;
        let up = -(0.75 + f64::from(number)) * ROW * high;
        let [x, y] = [along, up].map(|at| (at / grid_m).round() * grid_m);
        row.texts.push(label(place(x, y, 0.0), high, rgb, text));
        before += text.len() + GAP;
    }
    row
}
