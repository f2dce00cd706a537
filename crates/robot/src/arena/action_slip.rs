//! Slipping actions: now and then another action is executed than the chosen one.

use crate::streams::StreamName;
use xcs::Action;
use xcs::random::Stream;
use xcs::settings;

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

/// An arena that adds slipping actions to any other arena. Slips are drawn before the action
/// begins, from their own stream. A given sequence of actions therefore slips the same way in every
/// arena.
pub struct SlippingArena {
    arena: Box<dyn Arena>,
    slip: f64,
    stream: Stream,
    executed: Option<Action>,
}

impl SlippingArena {
    /// Makes actions of `arena` slip with probability `slip`. The slips follow from `seed`.
    pub fn new(arena: Box<dyn Arena>, slip: f64, seed: u64) -> Self {
        Self {
            arena,
            slip,
            stream: Stream::new(seed, StreamName::Slip),
            executed: None,
        }
    }

    /// Returns the action that is executed when `chosen` is chosen. Always draws the same count of
    /// random numbers.
    fn slipped(&mut self, chosen: Action) -> Action {
        let actions = self.arena.view().maze.action_count();
        let slips = self.stream.chance(self.slip);
        let other = self.stream.below(actions.saturating_sub(1).max(1));
        let other = other + usize::from(other >= chosen.index());
        match Action::new(other) {
            Some(other) if slips && chosen.index() < actions => other,
            _ => chosen,
        }
    }
}

impl Arena for SlippingArena {
    fn reset(&mut self, start: Cell) {
        self.executed = None;
        self.arena.reset(start);
    }

    fn act(&mut self, action: Action) -> Outcome {
        let executed = self.slipped(action);
        self.executed = Some(executed);
        self.arena.act(executed)
    }

    fn view(&self) -> View<'_> {
        View {
            executed: self.executed,
            ..self.arena.view()
        }
    }

    fn set_clock(&mut self, time_ns: u64) {
        self.arena.set_clock(time_ns);
    }

    fn reseed(&mut self, seed: u64) {
        self.executed = None;
        self.stream = Stream::new(seed, StreamName::Slip);
        self.arena.reseed(seed);
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

    /// Returns the executed actions when the robot always chooses to go north.
    fn executed(arena: Box<dyn Arena>, slip: f64, count: usize) -> Vec<usize> {
        let mut arena = SlippingArena::new(arena, slip, 1);
        let (start, north) = (arena.view().cell, Action::new(0).unwrap());
        let carried_out = |_| {
            arena.reset(start);
            arena.act(north);
            arena.view().executed.unwrap().index()
        };
        (0..count).map(carried_out).collect()
    }

    fn grid() -> Box<dyn Arena> {
        Box::new(GridArena::new(maze()))
    }

    #[test]
    fn other_actions_are_executed_with_the_requested_probability() {
        let executed = executed(grid(), 0.3, 10_000);
        let counts = [0, 1, 2, 3].map(|action| executed.iter().filter(|&&e| e == action).count());
        // Standard deviations: 46 for the first action, 30 for each of the others.
        assert!(counts[0].abs_diff(7_000) < 200, "{counts:?}");
        assert!(
            counts[1..].iter().all(|c| c.abs_diff(1_000) < 130),
            "{counts:?}"
        );
    }

    #[test]
    fn without_slip_the_chosen_action_is_executed() {
        assert_eq!(executed(grid(), 0.0, 200), [0; 200]);
    }

    #[test]
    fn the_same_actions_slip_in_both_arenas() {
        let physics = PhysicsArena::new(maze(), PhysicsParams::default(), 1).unwrap();
        assert_eq!(
            executed(Box::new(physics), 0.5, 40),
            executed(grid(), 0.5, 40)
        );
    }
}
