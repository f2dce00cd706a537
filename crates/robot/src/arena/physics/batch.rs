//! Several robots in copies of one maze, without interaction.

use super::fit::fitted;
use super::{PhysicsArena, PhysicsError, PhysicsParams, blocks, simulation};
use crate::arena::{Arena, Outcome, View};
use crate::world::{Cell, Maze};
use xcs::Action;

/// Robots that act together in copies of one maze, one robot per lane. Each lane is bit-identical
/// to a [`PhysicsArena`] with its seed. The robots share nothing but the shape of the walls.
pub struct BatchArena {
    arenas: Vec<PhysicsArena>,
    lanes: Lanes,
}

/// The observable state of all robots after a reset or an action, in columns with one entry per
/// lane.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Lanes {
    /// The robot's estimated cells.
    pub cells: Vec<Cell>,
    /// The x coordinate in the map frame, in metres.
    pub x_m: Vec<f64>,
    /// The y coordinate in the map frame, in metres.
    pub y_m: Vec<f64>,
    /// The heading as `[cosine, sine]` of the angle from the x axis of the map frame,
    /// counter-clockwise.
    pub headings: Vec<[f64; 2]>,
    /// Simulation time since the lane began, in nanoseconds.
    pub times_ns: Vec<u64>,
    /// The outcome of the last action; `None` after a reset.
    pub outcomes: Vec<Option<Outcome>>,
}

impl BatchArena {
    /// Creates one lane for each seed, with the robot in the first start cell.
    ///
    /// # Errors
    /// The same as [`PhysicsArena::new`].
    pub fn new(maze: &Maze, params: &PhysicsParams, seeds: &[u64]) -> Result<Self, PhysicsError> {
        params.check()?;
        let maze = &fitted(maze, params)?;
        let walls = simulation::walls(&blocks(maze)?, maze.solid());
        let arena = |&seed| PhysicsArena::among(walls.clone(), maze.clone(), params.clone(), seed);
        let mut batch = Self {
            arenas: seeds.iter().map(arena).collect(),
            lanes: Lanes::new(seeds.len()),
        };
        for lane in 0..seeds.len() {
            batch.record(lane, None);
        }
        Ok(batch)
    }

    /// Returns the number of lanes.
    pub fn len(&self) -> usize {
        self.arenas.len()
    }

    /// Returns true if there are no lanes.
    pub fn is_empty(&self) -> bool {
        self.arenas.is_empty()
    }

    /// Puts the robot of a lane at rest in the middle of `start`, a free cell. Does nothing if the
    /// lane does not exist.
    pub fn reset(&mut self, lane: usize, start: Cell) {
        if let Some(arena) = self.arenas.get_mut(lane) {
            arena.reset(start);
            self.record(lane, None);
        }
    }

    /// Lets each robot take the action at its lane number. Robots without an action do not move.
    pub fn act(&mut self, actions: &[Action]) -> &Lanes {
        for (lane, &action) in actions.iter().enumerate().take(self.len()) {
            let outcome = self.arenas[lane].act(action);
            self.record(lane, Some(outcome));
        }
        &self.lanes
    }

    /// Returns the current observable state of all robots.
    pub fn lanes(&self) -> &Lanes {
        &self.lanes
    }

    /// Returns the full view of one robot: its path, its collisions and its sensor readings.
    pub fn view(&self, lane: usize) -> Option<View<'_>> {
        self.arenas.get(lane).map(Arena::view)
    }

    fn record(&mut self, lane: usize, outcome: Option<Outcome>) {
        let arena = &self.arenas[lane];
        let now = arena.view().now();
        let pose = now.robot_in_map;
        self.lanes.cells[lane] = arena.cell;
        self.lanes.x_m[lane] = pose.translation.x;
        self.lanes.y_m[lane] = pose.translation.y;
        self.lanes.headings[lane] = [pose.rotation.re, pose.rotation.im];
        self.lanes.times_ns[lane] = now.time_ns;
        self.lanes.outcomes[lane] = outcome;
    }
}

impl Lanes {
    fn new(count: usize) -> Self {
        Self {
            cells: vec![Cell { col: 0, row: 0 }; count],
            x_m: vec![0.0; count],
            y_m: vec![0.0; count],
            headings: vec![[1.0, 0.0]; count],
            times_ns: vec![0; count],
            outcomes: vec![None; count],
        }
    }
}
