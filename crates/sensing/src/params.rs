//! The sensors of the robot at noise level 1, and the settings of its filter.

use nalgebra::{Complex, UnitComplex};

use crate::STEP_S;
use xcs::settings;

/// The range that a lidar needs, in cells. A beam crosses a diagonal neighbour after 1.5 to 2.1
/// cells, and two beams must. In 300 moves in a hall the default robot misperceived 264 percepts
/// with a range of 1.5 cells, 44 with 1.75, 11 with 1.8, and none with 1.9.
const RANGE_IN_CELLS: f64 = 1.9;

/// The parameters of a robot that its sensors and its onboard computer need.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotParams {
    /// Multiplies all deviations and rates of the sensors; 0 switches noise off.
    pub noise: f64,
    /// The edge length of the grid's cells in metres. Walls are on the lines of this grid.
    pub cell_size_m: f64,
    /// The distance between the wheels in metres.
    pub wheel_base_m: f64,
    /// The acceleration that a slippery floor still allows, in m/s^2: the limit of cautious
    /// driving.
    pub careful_acceleration_mps2: f64,
    /// The relative deviation of a wheel's distance on the floor from its count: the part that is
    /// constant during an action ...
    pub wheel_bias: f64,
    /// ... and the part that changes from step to step.
    pub wheel_noise: f64,
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
    /// The sensor faults.
    pub faults: FaultParams,
}

settings! {
    section "physics.lidar";

    /// A lidar modelled on the LDS-02 (0.16 to 8 m, 5 turns a second, 10 mm below 0.3 m, 3 % to 6
    /// m) and the RPLIDAR A1M8 (0.15 to 12 m, 5.5 turns, 1 %). Jitter, dropouts and outliers are
    /// assumptions.
    pub struct LidarParams {
        /// Whether the robot has a lidar.
        fitted: bool = true;
        /// Beams in a turn.
        beams: u32 = 32, in 4..=2048;
        /// Turns per second.
        rate_hz: f64 = 5.0, in 1.0..=20.0;
        /// Shortest range that is measured, in m. For anything nearer, a beam reports only that it
        /// is too near.
        nearest_m: f64 = 0.12, in 0.0..=1.0;
        /// Longest range that is measured, in m. Nothing comes back from farther away.
        range_m: f64 = 8.0, in 1.0..=100.0;
        /// Constant part of the deviation of a range, in m. `noise_share` is the other part.
        noise_m: f64 = 0.005, in 0.0..=0.05;
        /// Part of the deviation of a range that grows with it, as a share of the range.
        noise_share: f64 = 0.01, in 0.0..=0.05;
        /// Deviation of the scale, drawn once for each robot.
        scale: f64 = 0.01, in 0.0..=0.05;
        /// Deviation of the offset in m, drawn once for each robot.
        offset_m: f64 = 0.005, in 0.0..=0.05;
        /// Share of beams of which nothing comes back.
        dropouts: f64 = 0.01, in 0.0..=0.2;
    }
    constants {
        /// Deviation of a beam's direction in rad.
        jitter_rad: f64 = 0.004;
        /// Share of beams that report a random range.
        outliers: f64 = 0.005;
    }
}

impl LidarParams {
    /// Returns the directions of one turn, counter-clockwise from the heading.
    pub(crate) fn bearings(&self) -> Vec<UnitComplex<f64>> {
        let bearing = |beam: u32| {
            let share = f64::from(beam) / f64::from(self.beams);
            let (sine, cosine) = libm::sincos(share * std::f64::consts::TAU);
            UnitComplex::new_unchecked(Complex::new(cosine, sine))
        };
        (0..self.beams).map(bearing).collect()
    }

    /// Returns the assumed length of a beam that does not come back, in metres. It is at least 3 m
    /// and three cells, so that the beam leaves the cells next to the robot, but at most the
    /// lidar's range.
    pub fn lost_beam_range_m(&self, cell_size_m: f64) -> f64 {
        (3.0 * cell_size_m.max(1.0)).min(self.range_m)
    }

    /// Returns the size in metres of the largest cells that the lidar can distinguish from walls.
    /// In larger cells too few beams cross a diagonal neighbour before they reach
    /// [`range_m`](Self::range_m).
    pub fn largest_cell_m(&self) -> f64 {
        self.range_m / RANGE_IN_CELLS
    }

    /// Returns the number of physics steps in which the lidar completes a turn.
    pub fn steps_per_turn(&self) -> u64 {
        (1.0 / (self.rate_hz * STEP_S)).ceil() as u64
    }
}

settings! {
    section "physics.encoders";

    /// Encoders of the wheels; assumptions. They count how far the wheels roll. The noise of the
    /// wheels (`physics.wheel_bias`, `physics.wheel_noise`) acts between wheel and floor, so the
    /// encoders do not measure it.
    pub struct EncoderParams {
        /// Length of a tick in m.
        tick_m: f64 = 0.001, in 0.00001..=0.05;
        /// Relative deviation of the distance that a wheel's encoder counts, drawn once for each robot.
        scale: f64 = 0.02, in 0.0..=0.05;
    }
}

settings! {
    section "physics.gyro";

    /// A gyro modelled on the MPU-6050 (0.05 deg/s rms), with a residual bias after calibration.
    pub struct GyroParams {
        /// Whether the robot has a gyro.
        fitted: bool = true;
        /// Deviation of the turn rate in rad/s; 0.1 deg/s by default.
        noise_radps: f64 = 0.00175, in 0.0..=0.05;
        /// Deviation of the scale, drawn once for each robot.
        scale: f64 = 0.01, in 0.0..=0.05;
        /// Largest rate that the gyro measures, in rad/s; 1000 deg/s by default.
        range_radps: f64 = 17.45, in 1.0..=40.0;
    }
    constants {
        /// Deviation of the bias in rad/s, drawn once for each robot; 0.5 deg/s by default.
        bias_radps: f64 = 0.0087;
    }
}

settings! {
    section "physics.bumper";

    /// Bumpers in front and at the rear, 45 degrees to each side; assumptions.
    pub struct BumperParams {
        /// A push above this impulse closes the switch, in N s.
        impulse_ns: f64 = 0.3, in 0.01..=3.0;
    }
}

settings! {
    section "physics.faults";

    /// Sensor faults that start at some episode. The robot is not informed of them.
    pub struct FaultParams {
        /// First episode with the faults, counted from 1.
        from_episode: u32 = 1, in 1..=1_000_000;
        /// Width of the sector ahead in which the lidar gets no beam back, in degrees.
        dead_sector_deg: f64 = 0.0, in 0.0..=360.0;
        /// Freeze the encoder of the left wheel.
        stuck_encoder: bool = false;
        /// Growth of the gyro's bias, in rad/s per second. At 0.001 the bias is 3.4 deg/s after a
        /// minute.
        gyro_drift_radps2: f64 = 0.0, in 0.0..=0.1;
        /// Keep the front bumper open, whatever it touches.
        dead_bumper: bool = false;
    }
}

settings! {
    section "physics.estimator";

    /// The filter. Each mechanism has a switch, so that its benefit can be measured.
    pub struct EstimatorParams {
        /// Use every n-th beam of a turn, for the filter and for the percept. The computing time of a
        /// step grows with the number of beams.
        use_every_nth_beam: u32 = 1, in 1..=2048;
        /// Difference in m/s between wheels and gyro, beyond their noise, above which the wheels
        /// count as slipping.
        slip_mps: f64 = 0.2, in 0.002..=10.0;
    }
    constants {
        /// Factor by which the filter multiplies the noise of the sensors' data sheets. With less
        /// it would be overconfident, with more it accepts too many beams.
        caution: f64 = 1.2;
        /// Squared distance of a beam from a line, in units of its variance, above which the beam
        /// is rejected. 3 deviations by default.
        gate: f64 = 9.0;
        /// Trust the position less where several beams of the last steps disagree with it.
        batch_check: bool = true;
        /// Trust the wheels less in a step in which a bumper closes.
        bump_inflation: bool = true;
        /// Deviation by which the bias of the gyro may change in a second, in rad/s. The deviation
        /// grows with the square root of the time. At 0 the filter does not follow a drifting gyro.
        gyro_walk_radps: f64 = 0.0005;
        /// Time in s for which the floor is treated as slippery after wheel slip is detected.
        slip_s: f64 = 2.0;
    }
}
