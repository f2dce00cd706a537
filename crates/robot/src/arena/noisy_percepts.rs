//! Observation noise: bits of the percept are inverted at random.

use crate::streams::StreamName;
use xcs::random::Stream;
use xcs::{Action, Percept};

use super::{Arena, Outcome, View};
use crate::world::Cell;

/// An arena that adds observation noise to any other arena. The inverted bits are drawn each time
/// the robot comes to rest. The draws have their own stream and a fixed count, so they are the same
/// in every arena.
pub struct NoisyPerceptArena {
    arena: Box<dyn Arena>,
    /// The probability that a bit is inverted.
    flip_probability: f64,
    /// The number of bits in a percept.
    width: usize,
    stream: Stream,
    flipped: Percept,
}

impl NoisyPerceptArena {
    /// Inverts each of the `width` bits perceived in `arena` with probability `flip_probability`.
    /// The inverted bits follow from `seed`.
    pub fn new(arena: Box<dyn Arena>, flip_probability: f64, width: usize, seed: u64) -> Self {
        let mut noisy_percepts = Self {
            arena,
            flip_probability,
            width,
            stream: Stream::new(seed, StreamName::ObservationNoise),
            flipped: Percept::from_word(0, 0),
        };
        noisy_percepts.draw();
        noisy_percepts
    }

    fn draw(&mut self) {
        let Self {
            stream,
            flip_probability,
            ..
        } = self;
        let bits = (0..self.width).map(|_| stream.chance(*flip_probability));
        self.flipped = Percept::from_bits(bits).expect("as many bits as a percept");
    }
}

impl Arena for NoisyPerceptArena {
    fn reset(&mut self, start: Cell) {
        self.arena.reset(start);
        self.draw();
    }

    fn act(&mut self, action: Action) -> Outcome {
        let outcome = self.arena.act(action);
        self.draw();
        outcome
    }

    fn view(&self) -> View<'_> {
        View {
            flipped: Some(self.flipped),
            ..self.arena.view()
        }
    }

    fn set_clock(&mut self, time_ns: u64) {
        self.arena.set_clock(time_ns);
    }

    fn reseed(&mut self, seed: u64) {
        self.stream = Stream::new(seed, StreamName::ObservationNoise);
        self.arena.reseed(seed);
        self.draw();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arena::{GridArena, Localisation, PhysicsArena, PhysicsParams, SlippingArena};
    use crate::world::Maze;

    const ROWS: [&str; 5] = ["#####", "#...#", "#.S.#", "#..G#", "#####"];

    fn maze() -> Maze {
        Maze::from_json(format!(r#"{{ "rows": {ROWS:?} }}"#).as_bytes(), "m").unwrap()
    }

    /// Returns the inverted bits of `count` steps against a wall and back.
    fn flipped(arena: Box<dyn Arena>, probability: f64, count: usize) -> Vec<Percept> {
        let mut arena = NoisyPerceptArena::new(arena, probability, 16, 1);
        let start = arena.view().cell;
        arena.reset(start);
        let flipped = |number: usize| {
            arena.act(Action::new(number % 2 * 2).unwrap());
            arena.view().flipped.unwrap()
        };
        (0..count).map(flipped).collect()
    }

    fn grid() -> Box<dyn Arena> {
        Box::new(GridArena::new(maze()))
    }

    #[test]
    fn each_bit_flips_with_the_requested_probability() {
        let flipped = flipped(grid(), 0.02, 10_000);
        for bit in 0..16 {
            let count = flipped.iter().filter(|mask| mask.bit(bit)).count();
            // The standard deviation is 14.
            assert!(count.abs_diff(200) < 60, "bit {bit}: {count}");
        }
    }

    /// Returns all that a robot shows in a drive.
    fn shown(arena: &mut dyn Arena) -> String {
        let start = arena.view().cell;
        arena.reset(start);
        let act = |number: usize| {
            let outcome = arena.act(Action::new(number % 4).unwrap());
            format!("{outcome:?} {:?}", arena.view())
        };
        (0..12).map(act).collect()
    }

    #[test]
    fn a_reseeded_arena_equals_a_new_one() {
        let build = |localisation, seed| {
            let params = PhysicsParams {
                localisation,
                ..PhysicsParams::default()
            };
            let physics = PhysicsArena::new(maze(), params, seed).unwrap();
            let slipping = SlippingArena::new(Box::new(physics), 0.3, seed);
            NoisyPerceptArena::new(Box::new(slipping), 0.1, 16, seed)
        };
        for localisation in [Localisation::GroundTruth, Localisation::Estimated] {
            let mut used = build(localisation, 1);
            let first = shown(&mut used);
            used.reseed(2);
            let again = shown(&mut used);
            assert_eq!(again, shown(&mut build(localisation, 2)));
            assert_ne!(again, first, "control");
        }
    }

    #[test]
    fn the_same_bits_flip_in_both_arenas() {
        let physics = PhysicsArena::new(maze(), PhysicsParams::default(), 1).unwrap();
        let in_physics = flipped(Box::new(physics), 0.1, 20);
        assert_eq!(in_physics, flipped(grid(), 0.1, 20));
    }
}
