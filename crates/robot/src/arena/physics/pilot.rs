//! The pilot of a robot: localisation and controller, in the arena or on a real robot.

use std::sync::Arc;

use nalgebra::{Isometry2, Matrix3, Vector2};
use xcscr_sensing::{Onboard, STEP_NS, STEP_S};

use super::cautious::profile;
use super::controller::Maneuver;
use super::motion::{Now, Speeds};
use super::params::PhysicsParams;
use super::robot::Measured;
use super::{Localisation, lengths_m, vector};
use crate::arena::{LocalMap, Outcome};
use crate::sensor::Sensor;
use crate::world::{Cell, Direction, Maze};
use xcs::Percept;

/// The number of lidar turns before the first action of an episode. In one turn only two beams may
/// pass a narrow gap, and losing one of them must not close the gap.
const TURNS_BEFORE_START: u64 = 2;

/// Where the pilot has the robot's pose from.
enum Localiser {
    /// From the sensors of the robot.
    Onboard(Box<Onboard>),
    /// From the simulation: the pose and the speeds that were measured last.
    Told(Isometry2<f64>, Speeds),
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
    /// The time of its begin.
    since_ns: u64,
    /// What was known at the last command.
    seen: Now,
    timed_out: bool,
}

/// Localises a robot and drives it from cell to cell: readings in, speeds out. The pilot of
/// [`PhysicsArena`](super::PhysicsArena) is the pilot of a real robot.
///
/// One action is [`begin`](Self::begin), then [`step`](Self::step) until it returns no speeds, then
/// [`end`](Self::end). A step is [`sense`](Self::sense) and [`command`](Self::command). `drive` calls
/// the two by themselves, because it gets a lidar turn at its end: the filter processes readings in
/// steps of 50 ms, late, and a command takes the pose that odometry has found since. For the same
/// reason an action is over only once the readings of its end are processed
/// ([`has_seen`](Self::has_seen)). All poses are in the grid frame, in metres.
///
/// Arena and `drive` differ where their robots do. A real robot has no bumper here, so `drive` looks for
/// obstacles in the scans and calls [`back_off`](Self::back_off). It has no sensor for the marker of a
/// goal, so [`end`](Self::end) hears from the map whether it is in one. And only the arena's motors
/// accelerate gently while wheels slip.
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
    /// The time up to which readings are processed.
    time_ns: u64,
    /// The time up to which readings must be processed before the next decision.
    rests_until_ns: u64,
}

impl Pilot {
    /// Creates a pilot for a robot with these settings. The pilot knows the size of the cells, and
    /// in a world from a map the map.
    pub fn new(params: &PhysicsParams, maze: &Maze) -> Self {
        let cell_size_m = maze.cell_size_m();
        let knows_map = maze.is_from_map() && params.localisation == Localisation::Estimated;
        let localiser = match params.localisation {
            Localisation::GroundTruth => Localiser::Told(Isometry2::identity(), Speeds::REST),
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
            time_ns: 0,
            rests_until_ns: 0,
        }
    }

    /// Sets the pose of the robot at rest, with these deviations: in metres, and in radians. The robot
    /// must rest until the pilot has looked round ([`has_seen`](Self::has_seen)).
    pub fn put_down(&mut self, pose: Isometry2<f64>, deviations: [f64; 2], time_ns: u64) {
        self.action = None;
        self.time_ns = time_ns;
        self.rests_until_ns = time_ns + TURNS_BEFORE_START * self.turn_ns();
        match &mut self.localiser {
            Localiser::Onboard(onboard) => onboard.put_down_within(pose, deviations),
            told => *told = Localiser::Told(pose, Speeds::REST),
        }
    }

    /// Returns the duration of a lidar turn in whole steps, in nanoseconds; 0 with ground truth.
    fn turn_ns(&self) -> u64 {
        match self.localiser {
            Localiser::Onboard(_) => self.params.lidar.steps_per_turn() * STEP_NS,
            Localiser::Told(..) => 0,
        }
    }

    /// Processes what the robot measured in the next 50 ms, and returns the command for the 50 ms
    /// after them, as [`command`](Self::command) does.
    pub fn step(&mut self, measured: &Measured<'_>) -> Option<Speeds> {
        self.sense(measured);
        self.command(self.now())
    }

    /// Processes what the robot measured in the next 50 ms. A wall that it hits makes it drive back,
    /// unless the wall is behind the target.
    pub fn sense(&mut self, measured: &Measured<'_>) {
        self.time_ns += STEP_NS;
        match (measured, &mut self.localiser) {
            (Measured::Sensors(readings), Localiser::Onboard(onboard)) => onboard.step(readings),
            (&Measured::GroundTruth { pose, speeds, .. }, told @ Localiser::Told(..)) => {
                *told = Localiser::Told(pose, speeds);
            }
            // The robot and its pilot have the same settings, so they agree.
            (Measured::Sensors(_), Localiser::Told(..))
            | (Measured::GroundTruth { .. }, Localiser::Onboard(_)) => {}
        }
        if let Some(Action { maneuver, seen, .. }) = &mut self.action
            && maneuver.is_stopped_by_walls(seen)
            && measured.is_hit(maneuver)
        {
            maneuver.back_off();
        }
    }

    /// Returns what is known of the robot after the last processed readings.
    pub fn now(&self) -> Now {
        let speeds = match &self.localiser {
            Localiser::Onboard(onboard) => {
                let (forward_mps, turn_radps) = onboard.speeds();
                Speeds {
                    forward_mps,
                    turn_radps,
                }
            }
            Localiser::Told(_, speeds) => *speeds,
        };
        Now {
            pose: self.estimate().0,
            speeds,
            time_ns: self.time_ns,
        }
    }

    /// Returns true if all readings are processed up to the end of the last manoeuvre, or of the look
    /// round after the robot was put down.
    pub fn has_seen(&self) -> bool {
        self.time_ns + STEP_NS > self.rests_until_ns
    }

    /// Returns the onboard computer, for its observations; `None` without one.
    pub fn onboard(&self) -> Option<&Onboard> {
        match &self.localiser {
            Localiser::Onboard(onboard) => Some(onboard),
            Localiser::Told(..) => None,
        }
    }

    /// Returns the estimated pose, and the covariance of x, y and heading.
    pub fn estimate(&self) -> (Isometry2<f64>, Matrix3<f64>) {
        match &self.localiser {
            Localiser::Onboard(onboard) => onboard.estimate(),
            Localiser::Told(pose, _) => (*pose, Matrix3::zeros()),
        }
    }

    /// Returns true if wheel slip was detected recently.
    pub fn slips(&self) -> bool {
        self.onboard().is_some_and(Onboard::slips)
    }

    /// Starts to drive one cell in a direction. Returns the first command. Discards earlier
    /// observations. A move that the map bars ends as blocked, without driving: the robot may fit
    /// through, but with less space beside it than a move needs.
    pub fn begin(&mut self, direction: Direction, now: Now) -> Option<Speeds> {
        if let Localiser::Onboard(onboard) = &mut self.localiser {
            onboard.begin_action();
        }
        let home = self.grid_cell();
        let middle = home.map(|cells| (f64::from(cells) + 0.5) * self.cell_size_m);
        let (east, south) = direction.offset();
        self.action = Some(Action {
            maneuver: Maneuver::new(middle.into(), vector(direction), self.lengths_m, &now),
            is_barred: self.is_barred(direction),
            home,
            wanted: [home[0] + east, home[1] - south],
            since_ns: now.time_ns,
            seen: now,
            timed_out: false,
        });
        self.command(now)
    }

    /// Returns true if the map bars a move from the estimated cell. From a cell that should be a
    /// wall every move is allowed.
    fn is_barred(&self, direction: Direction) -> bool {
        self.map.as_ref().is_some_and(|map| {
            let cell = self.cell(map).filter(|&cell| !map.is_wall(cell));
            cell.is_some_and(|cell| map.step(cell, direction).is_none())
        })
    }

    /// Returns the commanded speeds of the manoeuvre, for what is known of the robot now. Returns
    /// `None` if the manoeuvre is over, or there is none. The robot rests at its end until the lidar
    /// has completed a turn. The speeds never exceed the robot's settings.
    pub fn command(&mut self, now: Now) -> Option<Speeds> {
        let params = profile(&self.params, &self.careful, self.slips());
        let turn_ns = self.turn_ns();
        let action = self.action.as_mut()?;
        self.rests_until_ns = now.time_ns;
        let passed_ns = now.time_ns.saturating_sub(action.since_ns);
        let time_out_steps = (self.params.time_out_s / STEP_S).round() as u64;
        if passed_ns >= time_out_steps * STEP_NS {
            action.timed_out = true;
            return None;
        }
        action.seen = now;
        let speeds = match action.is_barred {
            true => None,
            false => action.maneuver.command(&now, params),
        };
        match speeds {
            Some(speeds) => Some(speeds.limited(&self.params)),
            None => (passed_ns < turn_ns).then_some(Speeds::REST),
        }
    }

    /// Returns the direction of travel as a unit vector, and the distance to the end of the path in
    /// metres. Returns `None` while the robot turns.
    pub fn path(&self, now: &Now) -> Option<(Vector2<f64>, f64)> {
        let maneuver = &self.action.as_ref()?.maneuver;
        let left_m = maneuver.left_m(now)?;
        Some((maneuver.along(), left_m))
    }

    /// Returns the direction of the manoeuvre as a unit vector; the x axis without a manoeuvre.
    pub(super) fn along(&self) -> Vector2<f64> {
        let action = self.action.as_ref();
        action.map_or(Vector2::x(), |action| action.maneuver.along())
    }

    /// Makes the robot drive back to where the manoeuvre started, because of an obstacle. Returns false
    /// for a robot that drives back already.
    pub fn back_off(&mut self) -> bool {
        let action = self.action.as_mut();
        let turned = action.filter(|action| !action.maneuver.backs_off());
        turned.map(|action| action.maneuver.back_off()).is_some()
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
            Outcome::Collided { impulse_n_s: None }
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
            Localiser::Told(pose, _) => {
                let at = pose.translation.vector / self.cell_size_m;
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
