//! Auxiliary rewards: cells that pay the robot once in an episode.

use super::{Arena, Lasting, Outcome, View};
use crate::world::{Cell, Maze};
use xcs::Action;

/// Any arena of a maze in which cells pay by themselves. Such a cell pays when the robot comes into
/// it, for the first time in the episode, wherever it believes to be.
pub struct RewardingArena {
    arena: Box<dyn Arena>,
    /// The cells that have paid in this episode.
    spent: Vec<Cell>,
}

impl RewardingArena {
    /// Around an arena.
    pub fn new(arena: Box<dyn Arena>) -> Self {
        let spent = Vec::new();
        Self { arena, spent }
    }

    /// What the cell pays in which the robot really is, if it has not yet.
    fn found(&mut self) -> Option<f64> {
        let view = self.arena.view();
        let cell = true_cell(&view, view.maze)?;
        let reward = view.maze.auxiliary_reward(cell)?;
        let is_first = !self.spent.contains(&cell);
        self.spent.extend(is_first.then_some(cell));
        is_first.then_some(reward)
    }
}

fn true_cell(view: &View<'_>, maze: &Maze) -> Option<Cell> {
    maze.cell_at(view.now().robot_in_map.translation.vector.into())
}

impl Arena for RewardingArena {
    fn reset(&mut self, start: Cell) {
        self.spent.clear();
        self.arena.reset(start);
    }

    fn act(&mut self, action: Action) -> Outcome {
        let outcome = self.arena.act(action);
        match outcome {
            Outcome::Moved => self
                .found()
                .map_or(outcome, |reward| Outcome::FoundReward { reward }),
            _ => outcome,
        }
    }

    fn view(&self) -> View<'_> {
        self.arena.view()
    }

    fn lasting(&self) -> Lasting {
        self.arena.lasting()
    }

    fn continue_from(&mut self, lasting: &Lasting) {
        self.spent.clear();
        self.arena.continue_from(lasting);
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

    /// East, back, east again, on to the goal; twice.
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
    fn a_cell_pays_once_in_each_episode_in_both_arenas() {
        let physics = PhysicsArena::new(paid(), PhysicsParams::default(), 1).unwrap();
        let once = [7.0, 0.0, 0.0, 0.0, 0.0];
        for arena in [
            Box::new(GridArena::new(paid())) as Box<dyn Arena>,
            Box::new(physics),
        ] {
            assert_eq!(outcomes(arena), [once, once].concat());
        }
    }

    #[test]
    fn without_a_mark_nothing_is_paid() {
        let plain = maze("#S..G#", "");
        assert_eq!(outcomes(Box::new(GridArena::new(plain))), [0.0; 10]);
    }
}
