//! The gyro: the turned angle of the robot.
//!
//! It measures the change of the heading and not the engine's turn rate. The engine turns by the
//! arc tangent of rate times substep, which is 3 % less at full rate.

use crate::{GyroParams, STEP_S};
use xcs::random::Stream;

/// A gyro with bias, scale and noise.
#[derive(Debug, Clone)]
pub(super) struct Gyro {
    fitted: bool,
    bias_rad: f64,
    scale: f64,
    noise_rad: f64,
    most_rad: f64,
    pub(super) stream: Stream,
}

impl Gyro {
    /// Creates the gyro of the robot with `stream`, at a noise level.
    pub(super) fn new(params: &GyroParams, level: f64, mut stream: Stream) -> Self {
        Self {
            fitted: params.fitted,
            bias_rad: level * params.bias_radps * stream.normal() * STEP_S,
            scale: 1.0 + level * params.scale * stream.normal(),
            noise_rad: level * params.noise_radps * STEP_S,
            most_rad: params.range_radps * STEP_S,
            stream,
        }
    }

    /// Returns the reading of a step in which the robot turned by `turned_rad`.
    pub(super) fn read(&mut self, turned_rad: f64) -> Option<f64> {
        let noise_rad = self.noise_rad * self.stream.normal();
        let measured = turned_rad * self.scale + self.bias_rad + noise_rad;
        self.fitted
            .then(|| measured.clamp(-self.most_rad, self.most_rad))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stream() -> Stream {
        Stream::new(1, 10_u64)
    }

    #[test]
    fn without_noise_the_gyro_measures_the_turn_up_to_its_range() {
        let mut gyro = Gyro::new(&GyroParams::default(), 0.0, stream());
        assert_eq!(gyro.read(0.25), Some(0.25));
        assert_eq!(
            gyro.read(-3.0),
            Some(-GyroParams::default().range_radps * 0.05)
        );
    }

    #[test]
    fn at_rest_the_gyro_drifts_by_its_bias() {
        let mut gyro = Gyro::new(&GyroParams::default(), 1.0, stream());
        let sum: f64 = (0..2_000).filter_map(|_| gyro.read(0.0)).sum();
        assert!((sum - 2_000.0 * gyro.bias_rad).abs() < 0.02, "{sum}");
        assert!(gyro.bias_rad != 0.0);
    }

    #[test]
    fn a_robot_without_a_gyro_gets_no_reading() {
        let params = GyroParams {
            fitted: false,
            ..GyroParams::default()
        };
        assert_eq!(Gyro::new(&params, 1.0, stream()).read(0.1), None);
    }
}
