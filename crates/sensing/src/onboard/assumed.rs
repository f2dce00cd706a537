//! The sensor noise that the filter assumes.

use crate::{RobotParams, STEP_S};

/// The sensor noise that the filter assumes: standard deviations, lengths in metres.
#[derive(Debug, Clone)]
pub(super) struct Assumed {
    pub range: f64,
    pub range_share: f64,
    pub beam_rad: f64,
    pub roll_share: f64,
    pub roll_bias: f64,
    pub wheel_share: f64,
    pub turn_rad: f64,
    pub bias: f64,
    /// The change of the bias in a step, in rad/s.
    pub bias_walk: f64,
    pub gyro: f64,
    pub wheels: f64,
    pub ranges: f64,
    /// The wheels are counted in ticks, so each reading is off by less than one tick.
    pub tick_m: f64,
    pub wheel_base_m: f64,
    /// The largest change of the distance per step that a slippery floor allows, in metres.
    pub slippery_grip_m: f64,
}

impl Assumed {
    /// Takes the data sheets of the sensors at their noise level, times the caution factor. Without
    /// noise a minimum of about a thousandth remains, because the simulation has rounding errors.
    pub fn new(robot: &RobotParams) -> Self {
        let times = robot.noise * robot.estimator.caution;
        let of = |deviation: f64, least: f64| (times * deviation).max(least);
        let RobotParams {
            lidar,
            encoders,
            gyro,
            ..
        } = robot;
        Self {
            range: of(lidar.noise_m + lidar.offset_m, 0.002),
            range_share: of(lidar.noise_share, 0.001),
            beam_rad: of(lidar.jitter_rad, 0.002),
            roll_share: of(robot.wheel_noise, 0.01),
            roll_bias: of(robot.wheel_bias, 0.005),
            wheel_share: of(robot.wheel_bias.max(robot.wheel_noise), 0.01),
            turn_rad: of(gyro.noise_radps * STEP_S, 1e-4),
            bias: of(gyro.bias_radps, 1e-4),
            bias_walk: robot.estimator.gyro_walk_radps * STEP_S.sqrt(),
            gyro: of(gyro.scale, 0.002),
            wheels: of(encoders.scale, 0.002),
            ranges: of(lidar.scale, 0.001),
            tick_m: encoders.tick_m,
            wheel_base_m: robot.wheel_base_m,
            slippery_grip_m: robot.careful_acceleration_mps2 * STEP_S * STEP_S,
        }
    }
}
