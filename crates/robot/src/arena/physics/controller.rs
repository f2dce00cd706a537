//! One action: turn, drive one cell, or touch a wall and back off.

use nalgebra::{Point2, Vector2};

use super::motion::{Now, Speeds};
use super::params::PhysicsParams;

/// Turn rate per heading error in 1/s. Larger values oscillate at 20 Hz.
const HEADING_GAIN_PER_S: f64 = 12.5;
/// Largest heading correction (a sine).
const TRACK_LIMIT: f64 = 0.33;

/// The phase of a manoeuvre.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    /// Turning on the spot.
    Turn,
    /// Driving to the next cell.
    Drive,
    /// Driving back after a collision.
    Back,
}

/// The plan of one action; lengths in metres of the grid frame. It needs no trigonometry, because
/// angles are compared as sines and chords.
#[derive(Debug, Clone, Copy)]
pub(super) struct Maneuver {
    phase: Phase,
    home: Point2<f64>,
    target: Point2<f64>,
    /// A wall stops the robot only if it is farther than this from the target, in metres.
    settled_m: f64,
    /// Unit vector of travel.
    along: Vector2<f64>,
    /// 1 when driving forward, -1 when driving backward.
    facing: f64,
}

impl Maneuver {
    /// Plans a move from `home`, the middle of a cell, by one cell along the unit vector `along`.
    /// The robot drives forward or backward, whichever needs the smaller turn. A wall that it
    /// touches within `settled_m` of the target does not keep it from the target.
    pub(super) fn new(
        home: Point2<f64>,
        along: Vector2<f64>,
        [cell_size_m, settled_m]: [f64; 2],
        seen: &Now,
    ) -> Self {
        let heading = seen.pose.rotation * Vector2::x();
        Self {
            phase: Phase::Turn,
            home,
            target: home + along * cell_size_m,
            settled_m,
            along,
            facing: if heading.dot(&along) < 0.0 { -1.0 } else { 1.0 },
        }
    }

    /// Returns true if a wall ahead would keep the robot from reaching the next cell. Near the
    /// target the answer is false: a contact there means that the robot overshot and touched the
    /// wall behind the cell.
    pub(super) fn is_stopped_by_walls(&self, seen: &Now) -> bool {
        self.phase == Phase::Drive && self.ahead(seen) > self.settled_m
    }

    /// Returns true once the robot has hit a wall.
    pub(super) fn backs_off(&self) -> bool {
        self.phase == Phase::Back
    }

    /// Returns the distance to the end of the path, in metres; `None` while the robot turns.
    pub(super) fn left_m(&self, seen: &Now) -> Option<f64> {
        (self.phase != Phase::Turn).then(|| self.ahead(seen))
    }

    /// Returns true when driving forward.
    pub(super) fn front_leads(&self) -> bool {
        self.facing > 0.0
    }

    /// Returns the unit vector of travel.
    pub(super) fn along(&self) -> Vector2<f64> {
        self.along
    }

    /// Switches to driving back to the start without turning round.
    pub(super) fn back_off(&mut self) {
        self.phase = Phase::Back;
        self.target = self.home;
        self.along = -self.along;
        self.facing = -self.facing;
    }

    /// Returns the next command; `None` once the robot has arrived.
    pub(super) fn command(&mut self, seen: &Now, params: &PhysicsParams) -> Option<Speeds> {
        let face = self.facing * (seen.pose.rotation * Vector2::x());
        if self.phase == Phase::Turn {
            let sine = face.perp(&self.along);
            let aligned = sine.abs() < params.aligned && face.dot(&self.along) > 0.0;
            if !aligned || seen.speeds.turn_radps.abs() >= params.aligned_radps {
                return Some(self.turn(face, params));
            }
            self.phase = Phase::Drive;
        }
        self.drive(face, seen, params)
    }

    /// Turns as fast as it can while still able to stop in time.
    fn turn(&self, face: Vector2<f64>, params: &PhysicsParams) -> Speeds {
        let chord = (2.0 - 2.0 * face.dot(&self.along)).max(0.0).sqrt();
        let rate = (2.0 * params.turn_deceleration_radps2 * chord)
            .sqrt()
            .min(HEADING_GAIN_PER_S * chord)
            .min(params.max_turn_radps);
        Speeds {
            forward_mps: 0.0,
            turn_radps: rate.copysign(face.perp(&self.along)),
        }
    }

    /// Drives toward the target while holding heading and track.
    fn drive(&self, face: Vector2<f64>, seen: &Now, params: &PhysicsParams) -> Option<Speeds> {
        let ahead = self.ahead(seen);
        if ahead.abs() < params.arrival_m && seen.speeds.forward_mps.abs() < params.arrival_mps {
            return None;
        }
        let speed = (2.0 * params.deceleration_mps2 * ahead.abs())
            .sqrt()
            .min(params.max_speed_mps)
            .copysign(ahead);
        let left = Vector2::new(-self.along.y, self.along.x);
        let lean = speed.signum() * params.track_gain_per_m * self.missing(seen).dot(&left);
        let lean = lean.clamp(-TRACK_LIMIT, TRACK_LIMIT);
        let course = (1.0 - lean * lean).sqrt() * self.along + lean * left;
        let rate = HEADING_GAIN_PER_S * face.perp(&course);
        Some(Speeds {
            forward_mps: self.facing * speed,
            turn_radps: rate.clamp(-params.max_turn_radps, params.max_turn_radps),
        })
    }

    /// Returns the vector from the robot to the target.
    fn missing(&self, seen: &Now) -> Vector2<f64> {
        self.target.coords - seen.pose.translation.vector
    }

    /// Returns the distance to the target along the direction of travel; negative once passed.
    fn ahead(&self, seen: &Now) -> f64 {
        self.missing(seen).dot(&self.along)
    }
}
