//! The gyro: how far the robot turned.
//!
//! It is made from the change of the heading and not from the engine's turn rate: the engine turns
//! by the arc tangent of rate times substep, which is 3 % less at full rate.

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
    /// The gyro of the robot that draws from `stream`, at a noise level.
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

    /// What it tells about a step in which the robot turned by `turned_rad`.
    pub(super) fn read(&mut self, turned_rad: f64) -> Option<f64> {
        let noise_rad = self.noise_rad * self.stream.normal();
        let told = turned_rad * self.scale + self.bias_rad + noise_rad;
        self.fitted
            .then(|| told.clamp(-self.most_rad, self.most_rad))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stream() -> Stream {
        Stream::new(1, 10_u64)
    }

    #[test]
    fn without_noise_it_tells_the_turn_up_to_its_range() {
        let mut gyro = Gyro::new(&GyroParams::default(), 0.0, stream());
        assert_eq!(gyro.read(0.25), Some(0.25));
        assert_eq!(
            gyro.read(-3.0),
            Some(-GyroParams::default().range_radps * 0.05)
        );
    }

    #[test]
    fn it_drifts_at_rest_by_its_bias() {
        let mut gyro = Gyro::new(&GyroParams::default(), 1.0, stream());
        let told: f64 = (0..2_000).filter_map(|_| gyro.read(0.0)).sum();
        assert!((told - 2_000.0 * gyro.bias_rad).abs() < 0.02, "{told}");
        assert!(gyro.bias_rad != 0.0);
    }

    #[test]
    fn a_robot_without_a_gyro_is_told_nothing() {
        let params = GyroParams {
            fitted: false,
            ..GyroParams::default()
        };
        assert_eq!(Gyro::new(&params, 1.0, stream()).read(0.1), None);
    }
}
