//! Auxiliary rewards: cells that give a reward once per episode.

use super::{Arena, Outcome, View};
use crate::world::{Cell, Maze};
use xcs::Action;

/// An arena that adds auxiliary rewards to any other arena. A marked cell gives its reward when the
/// robot first enters it in an episode. The true position counts, not the estimated one.
pub struct RewardingArena {
    arena: Box<dyn Arena>,
    /// Cells whose reward was collected in this episode.
    collected: Vec<Cell>,
}

impl RewardingArena {
    /// Wraps an arena.
    pub fn new(arena: Box<dyn Arena>) -> Self {
        let collected = Vec::new();
        Self { arena, collected }
    }

    /// Returns the reward of the robot's true cell, unless it was already collected.
    fn collect(&mut self) -> Option<f64> {
        let view = self.arena.view();
        let cell = true_cell(&view, view.maze)?;
        let reward = view.maze.auxiliary_reward(cell)?;
        let is_first = !self.collected.contains(&cell);
        self.collected.extend(is_first.then_some(cell));
        is_first.then_some(reward)
    }
}

fn true_cell(view: &View<'_>, maze: &Maze) -> Option<Cell> {
    maze.cell_at(view.now().robot_in_map.translation.vector.into())
}

impl Arena for RewardingArena {
    fn reset(&mut self, start: Cell) {
        self.collected.clear();
        self.arena.reset(start);
    }

    fn act(&mut self, action: Action) -> Outcome {
        let outcome = self.arena.act(action);
        match outcome {
            Outcome::Moved => self
                .collect()
                .map_or(outcome, |reward| Outcome::FoundReward { reward }),
            _ => outcome,
        }
    }

    fn view(&self) -> View<'_> {
        self.arena.view()
    }

    fn set_clock(&mut self, time_ns: u64) {
        self.arena.set_clock(time_ns);
    }

    fn reseed(&mut self, seed: u64) {
        self.collected.clear();
        self.arena.reseed(seed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arena::{GridArena, PhysicsArena, PhysicsParams};

    fn maze(middle: &str, more: &str) -> Maze {
        let rows = ["######", middle, "######"];
        let text = format!(r#"{{ "rows": {rows:?}{more} }}"#);
        Maze::from_json(text.as_bytes(), "paid").unwrap()
    }

    fn paid() -> Maze {
        maze("#S*.G#", r#", "reward": 7.0"#)
    }

    /// Returns the rewards of moving east, west, east and on to the goal, twice.
    fn outcomes(arena: Box<dyn Arena>) -> Vec<f64> {
        let mut arena = RewardingArena::new(arena);
        let [east, west] = [1, 3].map(|index| Action::new(index).unwrap());
        let mut paid = Vec::new();
        for _ in 0..2 {
            arena.reset(Cell { col: 1, row: 1 });
            let drive = [east, west, east, east, east];
            paid.extend(drive.map(|action| arena.act(action).found()));
        }
        paid
    }

    #[test]
    fn a_cell_gives_its_reward_once_per_episode_in_both_arenas() {
        let physics = PhysicsArena::new(paid(), PhysicsParams::default(), 1).unwrap();
        let once = [7.0, 0.0, 0.0, 0.0, 0.0];
        for arena in [
            Box::new(GridArena::new(paid())) as Box<dyn Arena>,
            Box::new(physics),
        ] {
            assert_eq!(outcomes(arena), [once, once].concat());
        }
    }

    /// A grid arena whose robot believes to be in another cell.
    struct Mislocalised(GridArena, Cell);

    impl Arena for Mislocalised {
        fn reset(&mut self, start: Cell) {
            self.0.reset(start);
        }

        fn act(&mut self, action: Action) -> Outcome {
            self.0.act(action)
        }

        fn view(&self) -> View<'_> {
            let cell = self.1;
            View {
                cell,
                ..self.0.view()
            }
        }

        fn set_clock(&mut self, time_ns: u64) {
            self.0.set_clock(time_ns);
        }

        fn reseed(&mut self, seed: u64) {
            self.0.reseed(seed);
        }
    }

    #[test]
    fn a_mislocalised_robot_gets_the_reward_of_its_true_cell() {
        let estimated = |col| Mislocalised(GridArena::new(paid()), Cell { col, row: 1 });
        let once = [7.0, 0.0, 0.0, 0.0, 0.0];
        for col in [1, 2, 3] {
            let paid = outcomes(Box::new(estimated(col)));
            assert_eq!(paid, [once, once].concat(), "estimated in column {col}");
        }
    }

    #[test]
    fn without_a_marked_cell_there_is_no_reward() {
        let plain = maze("#S..G#", "");
        assert_eq!(outcomes(Box::new(GridArena::new(plain))), [0.0; 10]);
    }
}
