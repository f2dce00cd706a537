//! Perception errors, which only an observer can detect.

use serde::{Deserialize, Serialize};

use super::observer::{Observer, Step};
use xcscr_robot::arena::View;
use xcscr_robot::sensor::Sensor;
use xcscr_robot::world::Cell;

/// The number of perception errors of a robot that senses, or whose percepts have observation
/// errors.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Mistakes {
    /// Steps before which the percept differed from a perfect percept of the cell.
    pub observation_error: u64,
    /// Steps after which the robot was mislocalised: its estimated cell was not the true cell.
    pub mislocalised: u64,
}

impl Mistakes {
    /// Adds the counts of other steps.
    pub fn add(&mut self, other: Self) {
        self.observation_error += other.observation_error;
        self.mislocalised += other.mislocalised;
    }
}

/// Counts the perception errors of one episode.
#[derive(Debug)]
pub struct MistakeCounter {
    sensor: Sensor,
    /// The true cell of the robot before the step.
    stood: Option<Cell>,
    found: Mistakes,
}

impl MistakeCounter {
    /// Creates an observer with all counts at 0.
    pub fn new(sensor: Sensor) -> Self {
        Self {
            sensor,
            stood: None,
            found: Mistakes::default(),
        }
    }

    /// Returns the errors so far.
    pub fn found(&self) -> Mistakes {
        self.found
    }
}

/// Returns true if percepts can be wrong.
fn errs(view: &View<'_>) -> bool {
    view.sensed.is_some() || view.flipped.is_some()
}

/// Returns the free cell that contains the true position of the robot.
fn true_cell(view: &View<'_>) -> Option<Cell> {
    let at_m = view.now().robot_in_map.translation.vector.into();
    let cell = view.maze.cell_at(at_m);
    cell.filter(|&cell| !view.maze.is_wall(cell))
}

impl Observer for MistakeCounter {
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
        self.found.mislocalised +=
            u64::from(step.view.sensed.is_some_and(|sensed| sensed.mislocalised));
        self.stood = true_cell(&step.view);
    }
}
