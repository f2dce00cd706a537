//! What rules demand, in words.

use crate::agent::{Knowledge, PERCEPT_BITS, memory_words};
use crate::sensor::{ANYTHING, Alleles, Sensor};
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
    let seen = |alleles: Alleles<'_>| {
        let around = |at| alleles(at).filter(|_| at < PERCEPT_BITS);
        Some(sensor.words(maze, &around)).filter(|words| words != ANYTHING)
    };
    let mut words: Vec<String> = seen(alleles).into_iter().collect();
    words.extend(memory_words(alleles, &seen));
    match words.is_empty() {
        true => ANYTHING.to_owned(),
        false => words.join(", "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::agent::CONTEXT_BITS;

    #[test]
    fn what_is_seen_now_and_was_seen_a_step_ago_is_in_the_words_of_the_sensor() {
        let text = br######"{"rows": ["#####", "#S.G#", "#####"]}"######;
        let maze = Maze::from_json(text, "corridor.json").unwrap();
        // Two steps of twenty bits come last, of which four tell what was done.
        let last = CONTEXT_BITS - 2 * 20 + 4;
        let barred = |at: usize| [1, last + 1].contains(&at).then_some(true);
        let words = |sensor| words_of_memory(sensor, &maze, &barred);
        for (sensor, wall) in [
            (Sensor::Lidar, "north wall"),
            (Sensor::LidarPosition, "north wall"),
            (Sensor::Neighbours, "north wall or goal"),
        ] {
            assert_eq!(words(sensor), format!("{wall}, last step saw {wall}"));
        }
        // A lidar sees no goal: its bit says nothing.
        let goal = |at: usize| (at == last).then_some(true);
        let words = |sensor| words_of_memory(sensor, &maze, &goal);
        assert_eq!(words(Sensor::Lidar), "anything");
        assert_eq!(words(Sensor::Neighbours), "last step saw north goal");
    }
}
