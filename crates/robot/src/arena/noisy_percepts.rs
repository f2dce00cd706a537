//! Percepts that are misread: now and then a bit is perceived as its opposite.

use crate::streams::StreamName;
use xcs::random::Stream;
use xcs::{Action, Percept};

use super::{Arena, Lasting, Outcome, View};
use crate::world::Cell;

/// Any arena, in which bits of what is perceived flip. Which do is drawn when the robot has come to
/// rest, as many numbers each time, from a stream of its own: they are the same in every arena.
pub struct NoisyPerceptArena {
    arena: Box<dyn Arena>,
    /// The probability that a bit flips.
    flips: f64,
    /// The bits of a percept.
    width: usize,
    stream: Stream,
    flipped: Percept,
}

impl NoisyPerceptArena {
    /// Lets each of the `width` bits that are perceived in `arena` flip with the probability `flips`;
    /// which do follows from `seed`.
    pub fn new(arena: Box<dyn Arena>, flips: f64, width: usize, seed: u64) -> Self {
        let mut noisy_percepts = Self {
            arena,
            flips,
            width,
            stream: Stream::new(seed, StreamName::Flips),
            flipped: Percept::from_word(0, 0),
        };
        noisy_percepts.draw();
        noisy_percepts
    }

    fn draw(&mut self) {
        let Self { stream, flips, .. } = self;
        let bits = (0..self.width).map(|_| stream.chance(*flips));
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

    fn lasting(&self) -> Lasting {
        Lasting {
            flips: Some(self.stream.clone()),
            ..self.arena.lasting()
        }
    }

    fn continue_from(&mut self, lasting: &Lasting) {
        if let Some(stream) = &lasting.flips {
            self.stream = stream.clone();
        }
        self.arena.continue_from(lasting);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arena::{GridArena, PhysicsArena, PhysicsParams};
    use crate::world::Maze;

    const ROWS: [&str; 5] = ["#####", "#...#", "#.S.#", "#..G#", "#####"];

    fn maze() -> Maze {
        Maze::from_json(format!(r#"{{ "rows": {ROWS:?} }}"#).as_bytes(), "m").unwrap()
    }

    /// What flips in so many steps against a wall and back.
    fn flipped(arena: Box<dyn Arena>, flips: f64, count: usize) -> Vec<Percept> {
        let mut arena = NoisyPerceptArena::new(arena, flips, 16, 1);
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
    fn each_bit_flips_as_often_as_was_asked_for() {
        let flipped = flipped(grid(), 0.02, 10_000);
        for bit in 0..16 {
            let count = flipped.iter().filter(|mask| mask.bit(bit)).count();
            // The deviation is 14.
            assert!(count.abs_diff(200) < 60, "bit {bit}: {count}");
        }
    }

    #[test]
    fn the_same_bits_flip_in_both_arenas() {
        let physics = PhysicsArena::new(maze(), PhysicsParams::default(), 1).unwrap();
        let in_physics = flipped(Box::new(physics), 0.1, 20);
        assert_eq!(in_physics, flipped(grid(), 0.1, 20));
    }
}
