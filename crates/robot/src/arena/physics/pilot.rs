//! The pilot of a robot: localisation and controller, in the arena or on a real robot.

use std::sync::Arc;

use nalgebra::{Isometry2, Matrix3, Vector2};
use xcscr_sensing::{Onboard, PUT_DOWN, Readings, STEP_S};

use super::cautious::profile;
use super::controller::Maneuver;
use super::motion::{Motion, Speeds};
use super::params::PhysicsParams;
use super::{Localisation, STEP_NS, lengths_m, vector};
use crate::arena::{LocalMap, Outcome};
use crate::sensor::Sensor;
use crate::world::{Cell, Direction, Maze};
use xcs::Percept;

/// Where the pilot has the robot's pose from.
enum Localiser {
    /// From the sensors of the robot.
    Onboard(Box<Onboard>),
    /// From outside: the motion that was reported last.
    Told(Motion),
}

/// The current manoeuvre.
struct Action {
    maneuver: Maneuver,
    /// True if the map bars the move, so that the robot does not drive.
    is_barred: bool,
    /// The cell where the manoeuvre started, counted to the east and to the north.
    home: [i32; 2],
    /// The target cell.
    wanted: [i32; 2],
    /// The motion at the last command.
    seen: Motion,
    timed_out: bool,
}

/// Localises a robot and drives it from cell to cell: readings in, speeds out. The pilot of
/// [`PhysicsArena`](super::PhysicsArena) is the pilot of a real robot.
///
/// One action is [`begin`](Self::begin), then in each step [`command`](Self::command) and
/// [`sense`](Self::sense), then [`end`](Self::end). The filter processes sensor readings in steps of
/// 50 ms, possibly late; a command takes the current pose. All poses are in the grid frame, in
/// metres.
pub struct Pilot {
    localiser: Localiser,
    params: PhysicsParams,
    careful: PhysicsParams,
    /// The length of a move, and the distance from its end within which no wall stops it, in
    /// metres.
    lengths_m: [f64; 2],
    cell_size_m: f64,
    /// The map of a robot that localises itself in a world from a map.
    map: Option<Maze>,
    action: Option<Action>,
}

impl Pilot {
    /// Creates a pilot for a robot with these settings. The pilot knows the size of the cells, and
    /// in a world from a map the map.
    pub fn new(params: &PhysicsParams, maze: &Maze) -> Self {
        let cell_size_m = maze.cell_size_m();
        let knows_map = maze.is_from_map() && params.localisation == Localisation::Estimated;
        let localiser = match params.localisation {
            Localisation::GroundTruth => Localiser::Told(Motion::at_rest(Isometry2::identity())),
            Localisation::Estimated => {
                let onboard = Onboard::new(&params.robot(cell_size_m));
                Localiser::Onboard(Box::new(match maze.is_from_map() {
                    true => onboard.with_map(Arc::clone(maze.solid()) as _),
                    false => onboard,
                }))
            }
        };
        Self {
            localiser,
            careful: params.careful(),
            params: params.clone(),
            lengths_m: lengths_m(maze, params),
            cell_size_m,
            map: knows_map.then(|| maze.clone()),
            action: None,
        }
    }

    /// Sets the pose of the robot at rest, accurate to about a centimetre.
    pub fn put_down(&mut self, pose: Isometry2<f64>) {
        self.put_down_within(pose, PUT_DOWN);
    }

    /// Sets the pose of the robot at rest, with these deviations: in metres, and in radians.
    pub fn put_down_within(&mut self, pose: Isometry2<f64>, deviations: [f64; 2]) {
        self.action = None;
        match &mut self.localiser {
            Localiser::Onboard(onboard) => onboard.put_down_within(pose, deviations),
            Localiser::Told(motion) => *motion = Motion::at_rest(pose),
        }
    }

    /// Takes the pose after the next readings from another localiser, for a robot with an onboard
    /// computer.
    pub fn tell(&mut self, pose: Isometry2<f64>) {
        if let Localiser::Onboard(onboard) = &mut self.localiser {
            onboard.tell(pose);
        }
    }

    /// Processes the sensor readings of the next 50 ms. A bumper that closes in the direction of
    /// travel makes the robot drive back.
    pub fn sense(&mut self, readings: &Readings<'_>) {
        if let Localiser::Onboard(onboard) = &mut self.localiser {
            onboard.step(readings);
            let [front, rear] = onboard.bumped();
            let action = self.action.as_ref();
            if action.is_some_and(|action| match action.maneuver.front_leads() {
                true => front,
                false => rear,
            }) {
                self.stop_at_wall();
            }
        }
    }

    /// Takes the measured motion of a robot that does not localise itself.
    pub(super) fn locate(&mut self, measured: Motion) {
        self.localiser = Localiser::Told(measured);
    }

    /// Makes the robot drive back because of a wall ahead, unless the wall is behind the target.
    pub(super) fn stop_at_wall(&mut self) {
        if let Some(action) = &mut self.action
            && action.maneuver.is_stopped_by_walls(&action.seen)
        {
            action.maneuver.back_off();
        }
    }

    /// Returns the onboard computer, for its observations; `None` without one.
    pub fn onboard(&self) -> Option<&Onboard> {
        match &self.localiser {
            Localiser::Onboard(onboard) => Some(onboard),
            Localiser::Told(_) => None,
        }
    }

    /// Returns the estimated pose, and the covariance of x, y and heading.
    pub fn estimate(&self) -> (Isometry2<f64>, Matrix3<f64>) {
        match &self.localiser {
            Localiser::Onboard(onboard) => onboard.estimate(),
            Localiser::Told(motion) => (motion.pose, Matrix3::zeros()),
        }
    }

    /// Returns the estimated speeds.
    pub fn speeds(&self) -> Speeds {
        let (forward_mps, turn_radps) = match &self.localiser {
            Localiser::Onboard(onboard) => onboard.speeds(),
            Localiser::Told(motion) => (motion.forward_mps, motion.turn_radps),
        };
        Speeds {
            forward_mps,
            turn_radps,
        }
    }

    /// Returns true if wheel slip was detected recently.
    pub fn slips(&self) -> bool {
        self.onboard().is_some_and(Onboard::slips)
    }

    /// Starts to drive one cell in a direction, from a pose and speeds. Discards earlier
    /// observations. A move that the map bars ends as blocked, without driving: the robot may fit
    /// through, but with less space beside it than a move needs.
    pub fn begin(&mut self, direction: Direction, pose: Isometry2<f64>, speeds: Speeds) {
        if let Localiser::Onboard(onboard) = &mut self.localiser {
            onboard.begin_action();
        }
        let home = self.grid_cell();
        let middle = home.map(|cells| (f64::from(cells) + 0.5) * self.cell_size_m);
        let (east, south) = direction.offset();
        let seen = Motion::of(pose, speeds);
        self.action = Some(Action {
            maneuver: Maneuver::new(middle.into(), vector(direction), self.lengths_m, &seen),
            is_barred: self.is_barred(direction),
            home,
            wanted: [home[0] + east, home[1] - south],
            seen,
            timed_out: false,
        });
    }

    /// Returns true if the map bars a move from the estimated cell. From a cell that should be a
    /// wall every move is allowed.
    fn is_barred(&self, direction: Direction) -> bool {
        self.map.as_ref().is_some_and(|map| {
            let cell = self.cell(map).filter(|&cell| !map.is_wall(cell));
            cell.is_some_and(|cell| map.step(cell, direction).is_none())
        })
    }

    /// Returns the commanded speeds of the manoeuvre, `passed_ns` nanoseconds after its begin, for a robot at this
    /// pose and with these speeds. Returns `None` if the manoeuvre is over, or there is none. The
    /// robot rests at its end until the lidar has completed a turn. The speeds never exceed the
    /// robot's settings.
    pub fn command(
        &mut self,
        pose: Isometry2<f64>,
        speeds: Speeds,
        passed_ns: u64,
    ) -> Option<Speeds> {
        let params = profile(&self.params, &self.careful, self.slips());
        let turn_ns = match self.localiser {
            Localiser::Onboard(_) => self.params.lidar.steps_per_turn() * STEP_NS,
            Localiser::Told(_) => 0,
        };
        let action = self.action.as_mut()?;
        let time_out_steps = (self.params.time_out_s / STEP_S).round() as u64;
        if passed_ns >= time_out_steps * STEP_NS {
            action.timed_out = true;
            return None;
        }
        action.seen = Motion::of(pose, speeds);
        let speeds = match action.is_barred {
            true => None,
            false => action.maneuver.command(&action.seen, params),
        };
        match speeds {
            Some(speeds) => Some(speeds.limited(&self.params)),
            None => (passed_ns < turn_ns).then_some(Speeds::REST),
        }
    }

    /// Returns the direction of travel as a unit vector, and the distance to the end of the path in
    /// metres. Returns `None` while the robot turns.
    pub fn path(&self, pose: Isometry2<f64>) -> Option<(Vector2<f64>, f64)> {
        let maneuver = &self.action.as_ref()?.maneuver;
        let left_m = maneuver.left_m(&Motion::at_rest(pose))?;
        Some((maneuver.along(), left_m))
    }

    /// Returns the direction of the manoeuvre as a unit vector; the x axis without a manoeuvre.
    pub(super) fn along(&self) -> Vector2<f64> {
        let action = self.action.as_ref();
        action.map_or(Vector2::x(), |action| action.maneuver.along())
    }

    /// Makes the robot drive back to where the manoeuvre started, because of an obstacle. A robot that
    /// drives back already goes on.
    pub fn back_off(&mut self) {
        if let Some(action) = self.action.as_mut().filter(|it| !it.maneuver.backs_off()) {
            action.maneuver.back_off();
        }
    }

    /// Returns true while the robot drives back because of an obstacle.
    pub fn backs_off(&self) -> bool {
        let action = self.action.as_ref();
        action.is_some_and(|action| action.maneuver.backs_off())
    }

    /// Ends the manoeuvre. Returns its outcome by the estimated cell, for a robot that is in a goal
    /// or not. Without a manoeuvre the robot has stalled.
    pub fn end(&mut self, at_goal: bool) -> Outcome {
        let cell = self.grid_cell();
        let Some(action) = self.action.take() else {
            return Outcome::Stalled;
        };
        let in_time = !action.timed_out;
        let is_blocked = action.is_barred || action.maneuver.backs_off();
        if in_time && is_blocked && cell == action.home {
            Outcome::Collided { impulse_ns: None }
        } else if at_goal {
            Outcome::ReachedGoal
        } else if in_time && cell == action.wanted {
            Outcome::Moved
        } else {
            Outcome::Stalled
        }
    }

    /// Returns the estimated cell of a maze; `None` outside of the maze.
    pub fn cell(&self, maze: &Maze) -> Option<Cell> {
        maze.cell_in_grid(self.estimate().0.translation.vector.into())
    }

    /// Returns the estimated cell, counted to the east and to the north.
    fn grid_cell(&self) -> [i32; 2] {
        match &self.localiser {
            Localiser::Onboard(onboard) => onboard.cell(),
            Localiser::Told(motion) => {
                let at = motion.pose.translation.vector / self.cell_size_m;
                // The grid has at most 65,535 cells on a side.
                [at.x.floor() as i32, at.y.floor() as i32]
            }
        }
    }

    /// Returns the percept from the observations since the manoeuvre began; `None` outside of the
    /// maze.
    pub fn percept(&self, maze: &Maze, sensor: Sensor) -> Option<Percept> {
        let cell = self.cell(maze)?;
        let onboard = self.onboard().filter(|_| sensor.is_sensed());
        Some(match onboard {
            Some(onboard) => sensor.sense(maze, &local_map(onboard, cell)),
            None => sensor.perceive_at(maze, cell),
        })
    }
}

/// Returns what an onboard computer has observed of a robot in `cell`.
pub(super) fn local_map(onboard: &Onboard, cell: Cell) -> LocalMap<'_> {
    LocalMap {
        surroundings: onboard.surroundings(),
        obstacles: onboard.obstacles(),
        cell,
    }
}
