//! Descriptions of conditions in words.

use crate::agent::{Knowledge, PERCEPT_BITS, context_words};
use xcscr_robot::sensor::{ANYTHING, Alleles, Sensor};
use xcscr_robot::world::Maze;

impl Knowledge {
    /// Describes a condition of the rules in words. With a map, this includes the state and the
    /// last steps.
    pub fn words(&self, sensor: Sensor, maze: &Maze, alleles: Alleles<'_>) -> String {
        match self.remembers() {
            true => words_of_context(sensor, maze, alleles),
            false => sensor.words(maze, alleles),
        }
    }
}

/// Describes a condition on a context in words.
pub fn words_of_context(sensor: Sensor, maze: &Maze, alleles: Alleles<'_>) -> String {
    let seen = |alleles: Alleles<'_>| {
        // A sensor may have more bits than the context retains of its percept. The extra bits are
        // unspecified.
        let around = |at| (at < PERCEPT_BITS).then(|| alleles.allele(at)).flatten();
        Some(sensor.words(maze, &around)).filter(|words| words != ANYTHING)
    };
    let mut words: Vec<String> = seen(alleles).into_iter().collect();
    words.extend(context_words(&|at| alleles.allele(at), &|part| {
        seen(&|at| part(at))
    }));
    match words.is_empty() {
        true => ANYTHING.to_owned(),
        false => words.join(", "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::agent::CONTEXT_BITS;
    use xcs::{Condition, Percept};

    #[test]
    fn a_context_is_described_for_each_sensor_although_it_keeps_no_more_than_the_surroundings() {
        let text = br######"{"rows": ["#####", "#S.G#", "#####"]}"######;
        let maze = Maze::from_json(text, "corridor.json").unwrap();
        let context = Percept::from_bits((0..CONTEXT_BITS).map(|at| at % 3 == 0)).unwrap();
        let condition = Condition::exactly(&context);
        let alleles = |at| condition.allele(at);
        let wide = |sensor: &&Sensor| sensor.width(&maze) > PERCEPT_BITS;
        let sensors = Sensor::ALL
            .iter()
            .filter(|one| one.begins_with_neighbours());
        assert!(sensors.clone().any(|one| wide(&one)), "control");
        for sensor in sensors {
            let words = words_of_context(*sensor, &maze, &alleles);
            assert!(words.starts_with("north "), "{sensor:?}: {words}");
            assert!(
                words.contains("step before saw north "),
                "{sensor:?}: {words}"
            );
            assert!(!words.contains("column"), "{sensor:?}: {words}");
        }
    }

    #[test]
    fn present_and_last_percepts_are_described_in_the_words_of_the_sensor() {
        let text = br######"{"rows": ["#####", "#S.G#", "#####"]}"######;
        let maze = Maze::from_json(text, "corridor.json").unwrap();
        // The last two steps have twenty bits each; the first four bits encode the action.
        let last = CONTEXT_BITS - 2 * 20 + 4;
        let barred = |at: usize| [1, last + 1].contains(&at).then_some(true);
        let words = |sensor| words_of_context(sensor, &maze, &barred);
        for (sensor, wall) in [
            (Sensor::Lidar, "north wall"),
            (Sensor::LidarPosition, "north wall"),
            (Sensor::Neighbours, "north wall or goal"),
        ] {
            assert_eq!(words(sensor), format!("{wall}, last step saw {wall}"));
        }
        // A lidar does not see goals, so its goal bit is not described.
        let goal = |at: usize| (at == last).then_some(true);
        let words = |sensor| words_of_context(sensor, &maze, &goal);
        assert_eq!(words(Sensor::Lidar), "anything");
        assert_eq!(words(Sensor::Neighbours), "last step saw north goal");
    }
}
