//! Motion and localisation noise: wheels that slip and poses that are measured inaccurately.

use nalgebra::{Complex, Isometry2, Translation2, UnitComplex};

use super::params::PhysicsParams;
use xcs::random::Stream;

/// Draws all noise of the arena from one stream. At noise level 0 it draws nothing.
#[derive(Debug, Clone)]
pub(super) struct Noise {
    pub(super) stream: Stream,
    wheel_bias: f64,
    wheel_noise: f64,
    position_m: f64,
    heading_rad: f64,
}

impl Noise {
    /// Creates noise with the level and the deviations in `params`.
    pub(super) fn new(params: &PhysicsParams, stream: Stream) -> Self {
        Self {
            stream,
            wheel_bias: params.noise * params.wheel_bias,
            wheel_noise: params.noise * params.wheel_noise,
            position_m: params.noise * params.position_noise_m,
            heading_rad: params.noise * params.heading_noise_rad,
        }
    }

    /// Returns the relative excess speed of each wheel during a whole action.
    pub(super) fn wheel_bias(&mut self) -> [f64; 2] {
        [self.deviate(self.wheel_bias), self.deviate(self.wheel_bias)]
    }

    /// Returns the relative excess speed of each wheel during one step.
    pub(super) fn wheel_noise(&mut self) -> [f64; 2] {
        let deviation = self.wheel_noise;
        [self.deviate(deviation), self.deviate(deviation)]
    }

    /// Returns the pose as the robot measures it.
    pub(super) fn measure(&mut self, pose: &Isometry2<f64>) -> Isometry2<f64> {
        let (x, y) = (self.deviate(self.position_m), self.deviate(self.position_m));
        // A small rotation without sine and cosine, which differ between platforms.
        let twist = Complex::new(1.0, self.deviate(self.heading_rad));
        Isometry2::from_parts(
            Translation2::new(pose.translation.x + x, pose.translation.y + y),
            UnitComplex::new_normalize(twist) * pose.rotation,
        )
    }

    fn deviate(&mut self, deviation: f64) -> f64 {
        if deviation == 0.0 {
            return 0.0;
        }
        deviation * self.stream.normal()
    }
}
