//! What the sensors of the robot are like, at noise level 1.

use nalgebra::{Complex, UnitComplex};
use serde::{Deserialize, Serialize};

use crate::{EstimatorParams, STEP_S};
use xcs::bounds::{OutOfRange, within};

/// A robot, as its sensors and its own computer need to know it.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    /// Multiplies all deviations and rates of the sensors; 0 switches noise off.
    pub noise: f64,
    /// Distance between the wheels, in cells.
    pub wheel_base: f64,
    /// Deviation of what the wheels roll on the floor from what they count, as a share.
    pub wheel_deviation: f64,
    /// The lidar.
    pub lidar: LidarParams,
    /// The encoders of the wheels.
    pub encoders: EncoderParams,
    /// The gyro.
    pub gyro: GyroParams,
    /// The bumpers.
    pub bumper: BumperParams,
    /// The filter that estimates the pose.
    pub estimator: EstimatorParams,
}

/// A lidar after the LDS-02 (0.16 to 8 m, 5 turns a second, 10 mm below 0.3 m, 3 % to 6 m) and
/// the RPLIDAR A1M8 (0.15 to 12 m, 5.5 turns, 1 %). Lengths are for cells of 1 m. Jitter,
/// dropouts and outliers are assumed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LidarParams {
    /// Does the robot have one?
    pub fitted: bool,
    /// Beams in a turn, 4 to 128.
    pub beams: u32,
    /// Turns per second, 1 to 20.
    pub rate_hz: f64,
    /// Nothing comes back from nearer than this, in m, 0 to 0.2.
    pub nearest_m: f64,
    /// Nothing comes back from farther than this, in m, 2 to 40.
    pub range_m: f64,
    /// Deviation of a range in m, 0 to 0.05 ...
    pub noise_m: f64,
    /// ... and as a share of the range, which adds to it, 0 to 0.05.
    pub noise_share: f64,
    /// Deviation of the scale, drawn once for each robot, 0 to 0.05.
    pub scale: f64,
    /// Deviation of the offset in m, drawn once for each robot, 0 to 0.05.
    pub offset_m: f64,
    /// Deviation of a beam's direction in rad, 0 to 0.05.
    pub jitter_rad: f64,
    /// The share of beams of which nothing comes back, 0 to 0.2.
    pub dropouts: f64,
    /// The share of beams that tell any range, 0 to 0.05.
    pub outliers: f64,
}

impl Default for LidarParams {
    fn default() -> Self {
        Self {
            fitted: true,
            beams: 32,
            rate_hz: 5.0,
            nearest_m: 0.12,
            range_m: 8.0,
            noise_m: 0.005,
            noise_share: 0.01,
            scale: 0.01,
            offset_m: 0.005,
            jitter_rad: 0.004,
            dropouts: 0.01,
            outliers: 0.005,
        }
    }
}

impl LidarParams {
    /// Accepts the settings when each lies in its range.
    ///
    /// # Errors
    /// Names the first one that does not, and its range.
    pub fn check(&self) -> Result<(), OutOfRange> {
        within("physics.lidar.beams", self.beams, 4..=128)?;
        within("physics.lidar.rate_hz", self.rate_hz, 1.0..=20.0)?;
        within("physics.lidar.nearest_m", self.nearest_m, 0.0..=0.2)?;
        within("physics.lidar.range_m", self.range_m, 2.0..=40.0)?;
        within("physics.lidar.noise_m", self.noise_m, 0.0..=0.05)?;
        within("physics.lidar.noise_share", self.noise_share, 0.0..=0.05)?;
        within("physics.lidar.scale", self.scale, 0.0..=0.05)?;
        within("physics.lidar.offset_m", self.offset_m, 0.0..=0.05)?;
        within("physics.lidar.jitter_rad", self.jitter_rad, 0.0..=0.05)?;
        within("physics.lidar.dropouts", self.dropouts, 0.0..=0.2)?;
        within("physics.lidar.outliers", self.outliers, 0.0..=0.05)
    }

    /// The directions of one turn, counter-clockwise from the heading.
    pub(crate) fn bearings(&self) -> Vec<UnitComplex<f64>> {
        let bearing = |beam: u32| {
            let share = f64::from(beam) / f64::from(self.beams);
            let (sine, cosine) = libm::sincos(share * std::f64::consts::TAU);
            UnitComplex::new_unchecked(Complex::new(cosine, sine))
        };
        (0..self.beams).map(bearing).collect()
    }

    /// Beams in a physics step, on average.
    pub(crate) fn beams_per_step(&self) -> f64 {
        f64::from(self.beams) * self.rate_hz * STEP_S
    }

    /// Physics steps in which the lidar turns round once.
    pub fn steps_per_turn(&self) -> u64 {
        (1.0 / (self.rate_hz * STEP_S)).ceil() as u64
    }
}

/// Encoders of the wheels; assumed. They count what the wheels roll: the noise of the wheels
/// (`physics.wheel_bias`, `physics.wheel_noise`) comes between wheel and floor, unseen by them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct EncoderParams {
    /// A tick in m, 0.0001 to 0.05.
    pub tick_m: f64,
    /// Deviation of a wheel's scale, drawn once for each robot, 0 to 0.05.
    pub scale: f64,
}

impl Default for EncoderParams {
    fn default() -> Self {
        Self {
            tick_m: 0.001,
            scale: 0.02,
        }
    }
}

impl EncoderParams {
    /// Accepts the settings when each lies in its range.
    ///
    /// # Errors
    /// Names the first one that does not, and its range.
    pub fn check(&self) -> Result<(), OutOfRange> {
        within("physics.encoders.tick_m", self.tick_m, 0.0001..=0.05)?;
        within("physics.encoders.scale", self.scale, 0.0..=0.05)
    }
}

/// A gyro after the MPU-6050 (0.05 deg/s rms), with what is left of its bias after calibration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GyroParams {
    /// Does the robot have one?
    pub fitted: bool,
    /// Deviation of the turn rate in rad/s, 0 to 0.05: 0.1 deg/s.
    pub noise_radps: f64,
    /// Deviation of the bias in rad/s, drawn once for each robot, 0 to 0.2: 0.5 deg/s.
    pub bias_radps: f64,
    /// Deviation of the scale, drawn once for each robot, 0 to 0.05.
    pub scale: f64,
    /// The largest rate that it tells, in rad/s, 1 to 40: 1000 deg/s. The robot turns at 12.
    pub range_radps: f64,
}

impl Default for GyroParams {
    fn default() -> Self {
        Self {
            fitted: true,
            noise_radps: 0.00175,
            bias_radps: 0.0087,
            scale: 0.01,
            range_radps: 17.45,
        }
    }
}

impl GyroParams {
    /// Accepts the settings when each lies in its range.
    ///
    /// # Errors
    /// Names the first one that does not, and its range.
    pub fn check(&self) -> Result<(), OutOfRange> {
        within("physics.gyro.noise_radps", self.noise_radps, 0.0..=0.05)?;
        within("physics.gyro.bias_radps", self.bias_radps, 0.0..=0.2)?;
        within("physics.gyro.scale", self.scale, 0.0..=0.05)?;
        within("physics.gyro.range_radps", self.range_radps, 1.0..=40.0)
    }
}

/// Bumpers in front and at the rear, 45 degrees to each side; assumed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BumperParams {
    /// A push of more than this closes the switch, in N s, 0.01 to 3.
    pub impulse_ns: f64,
}

impl Default for BumperParams {
    fn default() -> Self {
        Self { impulse_ns: 0.3 }
    }
}

impl BumperParams {
    /// Accepts the settings when each lies in its range.
    ///
    /// # Errors
    /// Names the first one that does not, and its range.
    pub fn check(&self) -> Result<(), OutOfRange> {
        within("physics.bumper.impulse_ns", self.impulse_ns, 0.01..=3.0)
    }
}
