//! What is perceived wrongly, which only an observer can know.

use serde::{Deserialize, Serialize};

use super::observer::{Observer, Step};
use xcs::bounds::{OutOfRange, within};
use xcscr_robot::arena::View;
use xcscr_robot::sensor::Sensor;
use xcscr_robot::world::Cell;

/// How often a robot that senses, or whose percepts are misread, was mistaken.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Mistakes {
    /// Steps before which it perceived something else than perfect senses would have in that cell.
    pub observation_error: u64,
    /// Steps after which it believed to stand in another cell than it did.
    pub mislocalised: u64,
}

impl Mistakes {
    /// Accepts what can have happened in so many steps.
    ///
    /// # Errors
    /// The first number that is too large.
    pub fn check(&self, steps: u64) -> Result<(), OutOfRange> {
        within(
            "mistakes.observation_error",
            self.observation_error,
            0..=steps,
        )?;
        within("mistakes.mislocalised", self.mislocalised, 0..=steps)
    }

    /// Adds those of another stretch of steps.
    pub fn add(&mut self, other: Self) {
        self.observation_error += other.observation_error;
        self.mislocalised += other.mislocalised;
    }
}

/// Counts the mistakes of one episode.
#[derive(Debug)]
pub struct Watch {
    sensor: Sensor,
    /// Where the robot truly stood before the step.
    stood: Option<Cell>,
    found: Mistakes,
}

impl Watch {
    /// Nothing has happened yet.
    pub fn new(sensor: Sensor) -> Self {
        Self {
            sensor,
            stood: None,
            found: Mistakes::default(),
        }
    }

    /// The mistakes so far.
    pub fn found(&self) -> Mistakes {
        self.found
    }
}

/// Can what is perceived be wrong?
fn errs(view: &View<'_>) -> bool {
    view.sensed.is_some() || view.flipped.is_some()
}

/// The free cell in which the robot truly stands.
fn true_cell(view: &View<'_>) -> Option<Cell> {
    let at_m = view.now().robot_in_map.translation.vector.into();
    let cell = view.maze.cell_at(at_m);
    cell.filter(|&cell| !view.maze.is_wall(cell))
}

impl Observer for Watch {
    fn began(&mut self, _: u32, view: &View<'_>) {
        self.stood = errs(view).then(|| true_cell(view)).flatten();
    }

    fn stepped(&mut self, step: &Step<'_>) {
        if !errs(&step.view) {
            return;
        }
        let perfect = self
            .stood
            .map(|cell| self.sensor.perceive_at(step.view.maze, cell));
        self.found.observation_error +=
            u64::from(perfect.is_some_and(|perfect| perfect != step.percept));
        self.found.mislocalised += u64::from(step.view.sensed.is_some_and(|sensed| sensed.lost));
        self.stood = true_cell(&step.view);
    }
}
