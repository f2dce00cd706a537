//! What the sensors of the robot are like, at noise level 1, and how its filter works.

use nalgebra::{Complex, UnitComplex};

use crate::STEP_S;
use xcs::settings;

/// The range that a lidar needs, in cells. A beam crosses a neighbouring cell on the diagonal after 1.5 to 2.1 cells,
/// and two beams must. In 300 moves in a hall the default robot misread 264 percepts with a range of 1.5 cells, 44 with
/// 1.75, 11 with 1.8, and none with 1.9.
const RANGE_IN_CELLS: f64 = 1.9;

/// A robot, as its sensors and its own computer need to know it.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    /// Multiplies all deviations and rates of the sensors; 0 switches noise off.
    pub noise: f64,
    /// Edge length of the grid's cells in metres. Walls lie on the lines of this grid.
    pub cell_size_m: f64,
    /// Distance between the wheels in metres.
    pub wheel_base_m: f64,
    /// The acceleration that a slippery floor still allows, in m/s^2: that of cautious driving.
    pub careful_acceleration_mps2: f64,
    /// Deviation of what a wheel rolls on the floor from what it counts, as a share: of the part that
    /// stays for a whole action ...
    pub wheel_bias: f64,
    /// ... and of the part that changes from step to step.
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
    /// What is broken.
    pub faults: FaultParams,
}

settings! {
    section "physics.lidar";

    /// A lidar after the LDS-02 (0.16 to 8 m, 5 turns a second, 10 mm below 0.3 m, 3 % to 6 m) and
    /// the RPLIDAR A1M8 (0.15 to 12 m, 5.5 turns, 1 %). Jitter, dropouts and outliers are
    /// assumed.
    pub struct LidarParams {
        /// Does the robot have one?
        fitted: bool = true;
        /// Beams in a turn.
        beams: u32 = 32, in 4..=2048;
        /// Turns per second.
        rate_hz: f64 = 5.0, in 1.0..=20.0;
        /// The shortest range that is measured, in m. A beam that hits something nearer tells only that.
        nearest_m: f64 = 0.12, in 0.0..=1.0;
        /// Nothing comes back from farther than this, in m.
        range_m: f64 = 8.0, in 1.0..=100.0;
        /// Deviation of a range in m ...
        noise_m: f64 = 0.005, in 0.0..=0.05;
        /// ... and as a share of the range, which adds to it.
        noise_share: f64 = 0.01, in 0.0..=0.05;
        /// Deviation of the scale, drawn once for each robot.
        scale: f64 = 0.01, in 0.0..=0.05;
        /// Deviation of the offset in m, drawn once for each robot.
        offset_m: f64 = 0.005, in 0.0..=0.05;
        /// Deviation of a beam's direction in rad.
        jitter_rad: f64 = 0.004, in 0.0..=0.05;
        /// The share of beams of which nothing comes back.
        dropouts: f64 = 0.01, in 0.0..=0.2;
        /// The share of beams that tell any range.
        outliers: f64 = 0.005, in 0.0..=0.05;
    }
}

impl LidarParams {
    /// The directions of one turn, counter-clockwise from the heading.
    pub(crate) fn bearings(&self) -> Vec<UnitComplex<f64>> {
        let bearing = |beam: u32| {
            let share = f64::from(beam) / f64::from(self.beams);
            let (sine, cosine) = libm::sincos(share * std::f64::consts::TAU);
            UnitComplex::new_unchecked(Complex::new(cosine, sine))
        };
        (0..self.beams).map(bearing).collect()
    }

    /// Returns how far a beam that does not come back is taken to have gone, in metres: at least 3 m and three
    /// cells, so that it leaves the cells beside the robot, but no farther than the lidar sees.
    pub fn lost_beam_range_m(&self, cell_size_m: f64) -> f64 {
        (3.0 * cell_size_m.max(1.0)).min(self.range_m)
    }

    /// Returns the size in metres of the largest cells that the lidar can tell from walls. In larger cells too few
    /// beams cross a neighbouring cell on the diagonal before they reach [`range_m`](Self::range_m).
    pub fn largest_cell_m(&self) -> f64 {
        self.range_m / RANGE_IN_CELLS
    }

    /// Physics steps in which the lidar turns round once.
    pub fn steps_per_turn(&self) -> u64 {
        (1.0 / (self.rate_hz * STEP_S)).ceil() as u64
    }
}

settings! {
    section "physics.encoders";

    /// Encoders of the wheels; assumed. They count what the wheels roll: the noise of the wheels
    /// (`physics.wheel_bias`, `physics.wheel_noise`) comes between wheel and floor, unseen by them.
    pub struct EncoderParams {
        /// A tick in m.
        tick_m: f64 = 0.001, in 0.00001..=0.05;
        /// Deviation of a wheel's scale, drawn once for each robot.
        scale: f64 = 0.02, in 0.0..=0.05;
    }
}

settings! {
    section "physics.gyro";

    /// A gyro after the MPU-6050 (0.05 deg/s rms), with what is left of its bias after calibration.
    pub struct GyroParams {
        /// Does the robot have one?
        fitted: bool = true;
        /// Deviation of the turn rate in rad/s; 0.1 deg/s by default.
        noise_radps: f64 = 0.00175, in 0.0..=0.05;
        /// Deviation of the bias in rad/s, drawn once for each robot; 0.5 deg/s by default.
        bias_radps: f64 = 0.0087, in 0.0..=0.2;
        /// Deviation of the scale, drawn once for each robot.
        scale: f64 = 0.01, in 0.0..=0.05;
        /// The largest rate that it measures, in rad/s; 1000 deg/s by default.
        range_radps: f64 = 17.45, in 1.0..=40.0;
    }
}

settings! {
    section "physics.bumper";

    /// Bumpers in front and at the rear, 45 degrees to each side; assumed.
    pub struct BumperParams {
        /// A push of more than this closes the switch, in N s.
        impulse_ns: f64 = 0.3, in 0.01..=3.0;
    }
}

settings! {
    section "physics.faults";

    /// Sensors that break at some time. The robot does not know of it.
    pub struct FaultParams {
        /// The episode from which on they are broken, counted from 1.
        from_episode: u32 = 1, in 1..=1_000_000;
        /// The width of the sector ahead from which no beam of the lidar comes back, in degrees.
        dead_sector_deg: f64 = 0.0, in 0.0..=360.0;
        /// Does the encoder of the left wheel stand still?
        stuck_encoder: bool = false;
        /// How fast the bias of the gyro grows, in rad/s per second. At 0.001 it is 3.4 deg/s after
        /// a minute.
        gyro_drift_radps2: f64 = 0.0, in 0.0..=0.1;
        /// Does the front bumper never close?
        dead_bumper: bool = false;
    }
}

settings! {
    section "physics.estimator";

    /// The filter. Its mechanisms have switches, so that what each is good for can be measured.
    pub struct EstimatorParams {
        /// How many times the noise of the sensors' data sheets it assumes. With less it would be
        /// too sure of itself, with more it believes too many beams.
        caution: f64 = 1.2, in 0.5..=5.0;
        /// A beam whose squared distance from a line, in units of its variance, is more than this
        /// is not believed; 3 deviations by default.
        listener: f64 = 9.0, in 1.0..=10_000.0;
        /// The on-board computer takes every n-th beam of a turn, for the filter and for the map. What it
        /// computes in a step grows with the beams that it takes.
        use_every_nth_beam: u32 = 1, in 1..=2048;
        /// Trust the position less where several beams of the last steps disagree with it?
        batch_check: bool = true;
        /// Trust the wheels less in a step in which a bumper closes?
        bump_inflation: bool = true;
        /// Deviation by which the bias of the gyro may change in a second, in rad/s; the deviation grows
        /// with the root of the time. At 0 a gyro that drifts is not followed.
        gyro_walk_radps: f64 = 0.0005, in 0.0..=0.1;
        /// Wheels slip that disagree with the gyro by more than this, in m/s, beyond their noise ...
        slip_mps: f64 = 0.2, in 0.002..=10.0;
        /// ... and for so long afterwards the floor is held for slippery, in s.
        slip_s: f64 = 2.0, in 0.0..=60.0;
    }
}
