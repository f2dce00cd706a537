//! Disturbances of an arena: slipping actions and observation noise.

use crate::streams::StreamName;
use xcs::random::Stream;
use xcs::settings;
use xcs::{Action, Percept};

use super::{Arena, Outcome, View};
use crate::world::Cell;

settings! {
    section "arena";

    /// Settings that apply to every arena.
    pub struct ArenaParams {
        /// The probability that an action other than the chosen one is executed. All other actions
        /// are equally likely. At 0.75 with four actions, the choice has no effect.
        slip: f64 = 0.0, in 0.0..=0.75;
    }
}

/// How an arena is disturbed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disturbances {
    /// The probability that an action other than the chosen one is executed.
    pub slip: f64,
    /// The probability that a bit of the percept is inverted.
    pub flip_probability: f64,
    /// The number of bits in a percept.
    pub width: usize,
}

/// An arena that adds slipping actions and observation noise to any other arena. Slips are drawn before the action
/// begins, and the inverted bits each time the robot comes to rest. Both draw a fixed count of numbers from their own
/// stream, so a given sequence of actions is disturbed the same way in every arena.
pub struct DisturbedArena {
    arena: Box<dyn Arena>,
    disturbances: Disturbances,
    slips: Stream,
    noise: Stream,
    executed: Option<Action>,
    flipped: Percept,
}

impl DisturbedArena {
    /// Disturbs an arena. The disturbances follow from `seed`.
    pub fn new(arena: Box<dyn Arena>, disturbances: Disturbances, seed: u64) -> Self {
        let mut disturbed = Self {
            arena,
            disturbances,
            slips: Stream::new(seed, StreamName::Slip),
            noise: Stream::new(seed, StreamName::ObservationNoise),
            executed: None,
            flipped: Percept::from_word(0, 0),
        };
        disturbed.flip();
        disturbed
    }

    /// Returns the action that is executed when `chosen` is chosen.
    fn slipped(&mut self, chosen: Action) -> Action {
        let actions = self.arena.view().maze.action_count();
        let slips = self.slips.chance(self.disturbances.slip);
        let other = self.slips.below(actions.saturating_sub(1).max(1));
        let other = other + usize::from(other >= chosen.index());
        match Action::new(other) {
            Some(other) if slips && chosen.index() < actions => other,
            _ => chosen,
        }
    }

    /// Draws the inverted bits.
    fn flip(&mut self) {
        let Disturbances {
            flip_probability,
            width,
            ..
        } = self.disturbances;
        if flip_probability > 0.0 {
            let bits = (0..width).map(|_| self.noise.chance(flip_probability));
            self.flipped = Percept::from_bits(bits).expect("as many bits as a percept");
        }
    }
}

impl Arena for DisturbedArena {
    fn reset(&mut self, start: Cell) {
        self.executed = None;
        self.arena.reset(start);
        self.flip();
    }

    fn act(&mut self, action: Action) -> Outcome {
        let executed = self.slipped(action);
        self.executed = Some(executed);
        let outcome = self.arena.act(executed);
        self.flip();
        outcome
    }

    fn view(&self) -> View<'_> {
        let Disturbances {
            slip,
            flip_probability,
            ..
        } = self.disturbances;
        View {
            executed: self.executed.filter(|_| slip > 0.0),
            flipped: (flip_probability > 0.0).then_some(self.flipped),
            ..self.arena.view()
        }
    }

    fn set_clock(&mut self, time_ns: u64) {
        self.arena.set_clock(time_ns);
    }

    fn reseed(&mut self, seed: u64) {
        self.executed = None;
        self.slips = Stream::new(seed, StreamName::Slip);
        self.noise = Stream::new(seed, StreamName::ObservationNoise);
        self.arena.reseed(seed);
        self.flip();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arena::{GridArena, Localisation, PhysicsArena, PhysicsParams};
    use crate::world::Maze;

    const ROWS: [&str; 5] = ["#####", "#...#", "#.S.#", "#..G#", "#####"];

    fn maze() -> Maze {
        Maze::from_json(format!(r#"{{ "rows": {ROWS:?} }}"#).as_bytes(), "m").unwrap()
    }

    fn grid() -> Box<dyn Arena> {
        Box::new(GridArena::new(maze()))
    }

    fn disturbed(
        arena: Box<dyn Arena>,
        slip: f64,
        flip_probability: f64,
        seed: u64,
    ) -> DisturbedArena {
        let disturbances = Disturbances {
            slip,
            flip_probability,
            width: 16,
        };
        DisturbedArena::new(arena, disturbances, seed)
    }

    /// Returns the executed actions when the robot always chooses to go north, and the inverted bits.
    fn drawn(arena: Box<dyn Arena>, slip: f64, flips: f64, count: usize) -> Vec<(usize, Percept)> {
        let mut arena = disturbed(arena, slip, flips, 1);
        let (start, north) = (arena.view().cell, Action::new(0).unwrap());
        let carried_out = |_| {
            arena.reset(start);
            arena.act(north);
            let view = arena.view();
            (view.executed.unwrap().index(), view.flipped.unwrap())
        };
        (0..count).map(carried_out).collect()
    }

    #[test]
    fn other_actions_are_executed_and_bits_flip_with_the_requested_probabilities() {
        let drawn = drawn(grid(), 0.3, 0.02, 10_000);
        let executed = |action| drawn.iter().filter(|one| one.0 == action).count();
        // Standard deviations: 46 for the first action, 30 for each of the others.
        assert!(executed(0).abs_diff(7_000) < 200, "{}", executed(0));
        for action in 1..4 {
            let count = executed(action);
            assert!(count.abs_diff(1_000) < 130, "action {action}: {count}");
        }
        for bit in 0..16 {
            let count = drawn.iter().filter(|one| one.1.bit(bit)).count();
            // The standard deviation is 14.
            assert!(count.abs_diff(200) < 60, "bit {bit}: {count}");
        }
    }

    #[test]
    fn the_same_actions_slip_and_the_same_bits_flip_in_both_arenas() {
        let physics = PhysicsArena::new(maze(), PhysicsParams::default(), 1).unwrap();
        let in_physics = drawn(Box::new(physics), 0.5, 0.1, 40);
        assert_eq!(in_physics, drawn(grid(), 0.5, 0.1, 40));
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
            disturbed(Box::new(physics), 0.3, 0.1, seed)
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
}
