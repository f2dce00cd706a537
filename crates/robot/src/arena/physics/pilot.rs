//! The onboard computer and the controller of a robot, in the arena or outside of it: a real one, or
//! one behind a network.

use std::sync::Arc;

use nalgebra::{Isometry2, Vector2};
use xcscr_sensing::{Onboard, Readings};

use super::cautious::profile;
use super::controller::Maneuver;
use super::motion::{Motion, Speeds};
use super::params::PhysicsParams;
use super::{lengths_m, vector};
use crate::arena::{Estimate, Sample, Sensed, View};
use crate::sensor::Sensor;
use crate::world::{Cell, Direction, Maze};
use xcs::Percept;

/// How a manoeuvre ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ManeuverEnd {
    /// The robot is in the target cell.
    Reached,
    /// A wall blocked the robot, and it is back in the cell where it started.
    Blocked,
    /// The robot is in another cell.
    Elsewhere,
}

/// The current manoeuvre.
struct Action {
    maneuver: Maneuver,
    /// The cell where the manoeuvre started, counted to the east and to the north.
    home: [i32; 2],
    /// The target cell.
    wanted: [i32; 2],
}

/// The onboard computer and the controller of a robot that localises itself. It drives the robot
/// of [`PhysicsArena`](super::PhysicsArena), and robots that the arena does not simulate.
///
/// The filter processes sensor readings in steps of 50 ms ([`sense`](Self::sense)), possibly late.
/// The controller uses the current pose ([`command`](Self::command)). All poses are in the grid
/// frame, in metres.
pub struct Pilot {
    onboard: Onboard,
    params: PhysicsParams,
    careful: PhysicsParams,
    /// The length of a move, and the distance from its end within which no wall stops it, in
    /// metres.
    lengths_m: [f64; 2],
    action: Option<Action>,
}

impl Pilot {
    /// Creates a pilot for a robot with these settings. The robot knows the size of the cells, and
    /// in a world from a map the map.
    pub fn new(params: &PhysicsParams, maze: &Maze) -> Self {
        let cell_size_m = maze.cell_size_m();
        let onboard = Onboard::new(&params.robot(cell_size_m));
        let solid = maze.is_from_map().then(|| Arc::clone(maze.solid()));
        Self {
            onboard: match solid {
                Some(solid) => onboard.with_map(solid),
                None => onboard,
            },
            careful: params.careful(),
            params: params.clone(),
            lengths_m: lengths_m(maze, params),
            action: None,
        }
    }

    /// Sets the pose of the robot, accurate to about a centimetre.
    pub fn put_down(&mut self, pose: Isometry2<f64>) {
        self.onboard.put_down(pose);
        self.action = None;
    }

    /// Processes the sensor readings of the next 50 ms.
    pub fn sense(&mut self, readings: &Readings<'_>) {
        self.onboard.step(readings);
    }

    /// Returns the onboard computer, for its estimates.
    pub fn onboard(&self) -> &Onboard {
        &self.onboard
    }

    /// Starts to drive one cell in a direction, from a pose and speeds. Discards earlier
    /// observations.
    pub fn begin(&mut self, direction: Direction, pose: Isometry2<f64>, speeds: Speeds) {
        self.onboard.begin_action();
        let home = self.onboard.cell();
        let (east, south) = direction.offset();
        let middle = self.onboard.middle();
        let seen = Motion::of(pose, speeds);
        self.action = Some(Action {
            maneuver: Maneuver::new(middle, vector(direction), self.lengths_m, &seen),
            home,
            wanted: [home[0] + east, home[1] - south],
        });
    }

    /// Returns the commanded speeds of the manoeuvre for a robot at this pose and with these
    /// speeds. Returns `None` if the manoeuvre is over, or there is none. The speeds never exceed
    /// the robot's settings.
    pub fn command(&mut self, pose: Isometry2<f64>, speeds: Speeds) -> Option<Speeds> {
        let params = profile(&self.params, &self.careful, self.onboard.slips());
        let maneuver = &mut self.action.as_mut()?.maneuver;
        let speeds = maneuver.command(&Motion::of(pose, speeds), params)?;
        Some(speeds.limited(&self.params))
    }

    /// Returns the direction of travel as a unit vector while a wall could block the manoeuvre.
    /// Returns `None` while the robot turns, in the second half of the path, and while it backs
    /// off.
    pub fn travel_direction(&self, pose: Isometry2<f64>) -> Option<Vector2<f64>> {
        let maneuver = &self.action.as_ref()?.maneuver;
        let seen = Motion::of(pose, Speeds::REST);
        maneuver
            .is_stopped_by_walls(&seen)
            .then(|| maneuver.along())
    }

    /// Returns the direction of the manoeuvre as a unit vector; the x axis without a manoeuvre.
    pub(super) fn along(&self) -> Vector2<f64> {
        let action = self.action.as_ref();
        action.map_or(Vector2::x(), |action| action.maneuver.along())
    }

    /// Returns true if the bumper in the direction of the manoeuvre is closed.
    pub(super) fn is_bumped(&self) -> bool {
        let [front, rear] = self.onboard.bumped();
        let action = self.action.as_ref();
        action.is_some_and(|action| {
            if action.maneuver.front_leads() {
                front
            } else {
                rear
            }
        })
    }

    /// Makes the robot drive back to where the manoeuvre started, because of an obstacle.
    pub fn back_off(&mut self) {
        if let Some(action) = &mut self.action {
            action.maneuver.back_off();
        }
    }

    /// Ends the manoeuvre. Returns its end by the estimated cell; `None` without a manoeuvre.
    pub fn end(&mut self) -> Option<ManeuverEnd> {
        let action = self.action.take()?;
        let cell = self.onboard.cell();
        Some(if action.maneuver.backs_off() && cell == action.home {
            ManeuverEnd::Blocked
        } else if cell == action.wanted {
            ManeuverEnd::Reached
        } else {
            ManeuverEnd::Elsewhere
        })
    }

    /// Returns the estimated cell of a maze; `None` outside of the maze.
    pub fn cell(&self, maze: &Maze) -> Option<Cell> {
        maze.cell_in_grid(self.onboard.estimate().0.translation.vector.into())
    }

    /// Returns the percept from the observations since the manoeuvre began; `None` outside of the
    /// maze.
    pub fn percept(&self, maze: &Maze, sensor: Sensor) -> Option<Percept> {
        let cell = self.cell(maze)?;
        let (robot_in_grid, covariance) = self.onboard.estimate();
        let robot_in_map = maze.pose_in_map(robot_in_grid);
        let estimate = Estimate {
            robot_in_map,
            covariance,
        };
        let sample = Sample {
            time_ns: 0,
            robot_in_map,
            wheel_travel_m: [0.0; 2],
        };
        Some(sensor.perceive(&View {
            maze,
            cell,
            trace: &[sample],
            contacts: &[],
            sensed: Some(Sensed {
                surroundings: self.onboard.surroundings(),
                obstacles: self.onboard.obstacles(),
                cell,
                estimates: &[estimate],
                beams: &[],
                mislocalised: false,
            }),
            executed: None,
            flipped: None,
            wheels_mps: None,
        }))
    }
}
