//! What rules with a memory demand, in words.

use crate::agent::{PERCEPT_BITS, memory_words};
use crate::sensor::Sensor;
use crate::world::Maze;

/// Begins what such rules demand if that is nothing of the percept.
const OF_THE_PERCEPT_NOTHING: &str = "anything, ";

/// What a condition on a context demands, such as `north wall, x > 2`; `anything` if nothing. First
/// comes what it demands of the eight cells around the robot, in the words of `around`, then of the
/// place and of the last steps.
pub fn context_words(
    around: Sensor,
    maze: &Maze,
    alleles: &dyn Fn(usize) -> Option<bool>,
) -> String {
    let words = recorded_context_words(around, maze, alleles);
    match words.strip_prefix(OF_THE_PERCEPT_NOTHING) {
        Some(remembered) => remembered.to_owned(),
        None => words,
    }
}

/// The same as recordings have it, with `anything` ahead if nothing is demanded of the percept.
pub(crate) fn recorded_context_words(
    around: Sensor,
    maze: &Maze,
    alleles: &dyn Fn(usize) -> Option<bool>,
) -> String {
    let perceived = |bit| alleles(bit).filter(|_| bit < PERCEPT_BITS);
    let mut words = vec![around.words(maze, &perceived)];
    words.extend(memory_words(alleles));
    words.join(", ")
}
