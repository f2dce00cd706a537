//! Compares a robot that only senses with the ground truth during random moves, for the test
//! `sensing` and the bench of the same name.

#![allow(clippy::unwrap_used, reason = "a test ends there")]

use nalgebra::Point2;
use xcscr::arena::{Arena, Estimate, Outcome, PhysicsArena, View};
use xcscr::sensor::Sensor;
use xcscr::streams::StreamName;
use xcscr::world::Cell;
use xcscr::xcs::Action;
use xcscr::xcs::random::Stream;

/// Returns the true cell of the robot.
pub fn true_cell(view: &View<'_>) -> Cell {
    let at: Point2<f64> = view.now().robot_in_map.translation.vector.into();
    view.maze.cell_at(at).unwrap()
}

/// Returns random actions.
pub fn script(seed: u64, length: usize) -> impl Iterator<Item = Action> {
    let mut stream = Stream::new(seed, StreamName::Exploration);
    (0..length).map(move |_| Action::new(stream.below(4)).unwrap())
}

/// The numbers of errors of the robot, and the sizes of its estimation errors.
#[derive(Debug, Default)]
pub struct Tally {
    pub moves: u32,
    /// The number of physics steps.
    pub steps: u64,
    /// Moves after which the robot was in another cell than intended.
    pub wrong_cell: u32,
    /// Moves with a wrong outcome: false and missed collisions, and time-outs.
    pub wrong_outcome: u32,
    /// Moves after which the estimated cell was wrong.
    pub lost: u32,
    /// Moves with any of these errors.
    pub wrong: u32,
    pub wrong_percepts: u32,
    pub error_cm: Vec<f64>,
    pub heading_deg: Vec<f64>,
    pub nees: Vec<f64>,
}

impl Tally {
    /// Runs random moves. Resets the robot to the start if it is mislocalised or in a goal.
    pub fn of(arena: &mut PhysicsArena, seed: u64, moves: usize) -> Self {
        let mut tally = Self::default();
        for action in script(seed, moves) {
            tally.add(arena, action);
            let view = arena.view();
            if view.sensed.unwrap().mislocalised || view.maze.is_goal(true_cell(&view)) {
                let start = view.maze.start_cells()[0];
                arena.reset(start);
            }
        }
        tally
    }

    pub fn faults(&self) -> u32 {
        self.wrong_cell + self.wrong_outcome + self.lost
    }

    /// Runs one action and compares it with the ground truth.
    fn add(&mut self, arena: &mut PhysicsArena, action: Action) {
        let (maze, from) = (arena.view().maze, true_cell(&arena.view()));
        let wanted = maze.step(from, maze.direction(action).unwrap());
        let ends_in_goal = wanted.is_some_and(|cell| maze.is_goal(cell));
        let outcome = arena.act(action);
        let right = match outcome {
            Outcome::Moved => wanted.is_some() && !ends_in_goal,
            Outcome::ReachedGoal => ends_in_goal,
            Outcome::Collided { .. } => wanted.is_none(),
            Outcome::Stalled => false,
        };
        let before = self.faults();
        self.moves += 1;
        self.wrong_outcome += u32::from(!right);
        self.compare(&arena.view(), wanted.unwrap_or(from));
        self.wrong += u32::from(self.faults() > before);
    }

    fn compare(&mut self, view: &View<'_>, wanted: Cell) {
        let cell = true_cell(view);
        let sensed = view.sensed.unwrap();
        self.steps += view.trace.len() as u64 - 1;
        self.wrong_cell += u32::from(cell != wanted);
        self.lost += u32::from(sensed.mislocalised);
        let estimate: &Estimate = sensed.estimates.last().unwrap();
        let truth = view.now().robot_in_map;
        let (metres, radians) = estimate.error(&truth);
        self.error_cm.push(100.0 * metres);
        self.heading_deg.push(radians.to_degrees());
        self.nees.extend(estimate.nees(&truth));
        let perceived = Sensor::Lidar.perceive(view);
        let perfect = Sensor::Lidar.perceive_at(view.maze, cell);
        self.wrong_percepts += u32::from(perceived != perfect);
    }
}

/// Returns a quantile of the numbers.
pub fn quantile(numbers: &mut [f64], share: f64) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[((numbers.len() - 1) as f64 * share) as usize]
}

/// Returns the mean of the numbers.
pub fn mean(numbers: &[f64]) -> f64 {
    numbers.iter().sum::<f64>() / numbers.len() as f64
}
