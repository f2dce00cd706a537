//! The robot's drive: two wheels whose force is limited by the floor's friction.

use nalgebra::{Complex, Isometry2, Translation2, UnitComplex, Vector2};
use rapier2d::prelude::{RigidBody, Vector};

use super::STEP_S;
use super::motion::Speeds;
use super::params::{PhysicsParams, grip_mps2};

/// Time constant of the motors in s.
const MOTOR_LAG_S: f64 = 0.03;

/// The true motion of the robot's body; lengths in metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion {
    /// The pose in the grid frame.
    pub pose: Isometry2<f64>,
    /// Speed along the heading in m/s; negative when driving backward.
    pub forward_mps: f64,
    /// Speed to the left in m/s.
    pub sideways_mps: f64,
    /// Turn rate in rad/s, counter-clockwise.
    pub turn_radps: f64,
}

/// Returns the true motion of the robot's body in the engine.
pub(super) fn true_motion(body: &RigidBody) -> Motion {
    let (at, rotation, velocity) = (body.translation(), body.rotation(), body.linvel());
    let heading = Complex::new(f64::from(rotation.re), f64::from(rotation.im));
    let (x, y) = (f64::from(velocity.x), f64::from(velocity.y));
    Motion {
        pose: Isometry2::from_parts(
            Translation2::new(f64::from(at.x), f64::from(at.y)),
            UnitComplex::new_unchecked(heading),
        ),
        forward_mps: x * heading.re + y * heading.im,
        sideways_mps: y * heading.re - x * heading.im,
        turn_radps: f64::from(body.angvel()),
    }
}

/// Returns how far the left and the right wheel roll in each step of 50 ms, in metres, while the motors
/// follow one command a step. The wheels start at rest.
pub fn rolled_by(
    commands: impl IntoIterator<Item = Speeds>,
    params: &PhysicsParams,
) -> Vec<[f64; 2]> {
    let mut wheels = Wheels::default();
    let mut rolled = |speeds: Speeds| {
        wheels.follow(speeds.limited(params).rims_mps(params), params);
        wheels.speed_mps.map(|speed| speed * STEP_S)
    };
    commands.into_iter().map(&mut rolled).collect()
}

/// The left and the right wheel.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Wheels {
    /// Rolling speeds in m/s.
    speed_mps: [f64; 2],
    /// Rolled distances in metres.
    pub(super) travel_m: [f64; 2],
}

impl Wheels {
    /// Makes the motors follow commanded rim speeds for one step, with their lag and limited
    /// acceleration.
    pub(super) fn follow(&mut self, rims_mps: [f64; 2], params: &PhysicsParams) {
        let share = STEP_S / (MOTOR_LAG_S + STEP_S);
        let limit = params.wheel_acceleration_mps2 * STEP_S;
        for ((speed, travel), wanted) in self
            .speed_mps
            .iter_mut()
            .zip(&mut self.travel_m)
            .zip(rims_mps)
        {
            *speed += ((wanted - *speed) * share).clamp(-limit, limit);
            *travel += *speed * STEP_S;
        }
    }

    /// Pushes the body toward the wheels' speeds. On the floor each wheel turns too fast by the
    /// share `excess`. The force stays within the friction circle given by `friction`.
    pub(super) fn push(
        &self,
        body: &mut RigidBody,
        motion: &Motion,
        excess: [f64; 2],
        friction: [f64; 2],
        params: &PhysicsParams,
    ) {
        let [left, right] = [0, 1].map(|i| self.speed_mps[i] * (1.0 + excess[i]));
        let (mass, base) = (params.mass_kg, params.wheel_base_m);
        let inertia = 0.5 * mass * params.radius_m * params.radius_m;
        let along = mass * (0.5 * (left + right) - motion.forward_mps) / 2.0;
        let twist = inertia * ((right - left) / base - motion.turn_radps) / base;
        let across = -mass * motion.sideways_mps / 2.0;
        let limit = |friction| mass * grip_mps2(friction) * STEP_S / 2.0;
        let force = |along, friction| Vector2::new(along, across).cap_magnitude(limit(friction));
        let left = force(along - twist, friction[0]);
        let right = force(along + twist, friction[1]);
        let impulse = motion.pose.rotation * (left + right);
        body.apply_impulse(Vector::new(impulse.x as f32, impulse.y as f32), true);
        body.apply_torque_impulse(((right.x - left.x) * base / 2.0) as f32, true);
    }
}
