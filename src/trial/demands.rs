//! What rules demand, in words.

use crate::agent::{Knowledge, PERCEPT_BITS, memory_words};
use crate::sensor::{Alleles, Sensor};
use crate::world::Maze;

impl Knowledge {
    /// What a condition of the rules demands, in words; with a memory also of the place and of the
    /// last steps.
    pub fn words(&self, sensor: Sensor, maze: &Maze, alleles: Alleles<'_>) -> String {
        match self.remembers() {
            true => words_of_memory(sensor, maze, alleles),
            false => sensor.words(maze, alleles),
        }
    }
}

/// What a condition on a percept and a memory demands.
pub fn words_of_memory(sensor: Sensor, maze: &Maze, alleles: Alleles<'_>) -> String {
    let percept = |at| alleles(at).filter(|_| at < PERCEPT_BITS);
    let mut words = vec![sensor.words(maze, &percept)];
    words.extend(memory_words(alleles));
    if words.len() > 1 {
        words.retain(|word| word != "anything");
    }
    words.join(", ")
}
