//! Estimated and commanded motion of the robot.

use nalgebra::Isometry2;

use super::params::PhysicsParams;

/// What is known of a robot at the moment of a command.
#[derive(Debug, Clone, Copy)]
pub struct Now {
    /// The pose in the grid frame, in metres.
    pub pose: Isometry2<f64>,
    /// The speeds.
    pub speeds: Speeds,
    /// The time in nanoseconds of the robot's clock.
    pub time_ns: u64,
}

/// A speed along the heading and a turn rate.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Speeds {
    /// Speed along the heading in m/s; negative when it drives backward.
    pub forward_mps: f64,
    /// Turn rate in rad/s, counter-clockwise.
    pub turn_radps: f64,
}

impl Speeds {
    /// The speeds of a robot at rest.
    pub const REST: Self = Self {
        forward_mps: 0.0,
        turn_radps: 0.0,
    };

    /// Returns the speeds of the left and right rim in m/s.
    pub(super) fn rims_mps(self, params: &PhysicsParams) -> [f64; 2] {
        let turn = self.turn_radps * params.wheel_base_m / 2.0;
        [self.forward_mps - turn, self.forward_mps + turn]
    }

    /// Returns the speeds within the limits of the settings. NaN becomes 0.
    pub(super) fn limited(self, params: &PhysicsParams) -> Self {
        Self {
            forward_mps: within(self.forward_mps, params.max_speed_mps),
            turn_radps: within(self.turn_radps, params.max_turn_radps),
        }
    }
}

/// Clamps a number to `-most` to `most`. NaN becomes 0.
pub(super) fn within(number: f64, most: f64) -> f64 {
    match number.is_nan() {
        true => 0.0,
        false => number.clamp(-most, most),
    }
}
