//! The settings of robot, controller and noise.

use serde::{Deserialize, Serialize};

use super::cautious::CautiousParams;
use xcs::bounds::{OutOfRange, Setting, within};
use xcs::settings;
use xcscr_sensing::{
    BumperParams, EncoderParams, EstimatorParams, FaultParams, GyroParams, LidarParams, RobotParams,
};

/// How the robot is localised.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Localisation {
    /// The robot gets its true pose with some noise, which no real robot has. For percepts that are
    /// looked up in the maze, and for results published with them.
    #[default]
    GroundTruth,
    /// The robot estimates its pose from its wheels, its gyro and its lidar. Sensed percepts always
    /// require this mode.
    Estimated,
}

settings! {
    section "physics";
    also check_parts;

    /// The robot, its controller and its noise.
    ///
    /// The name of every setting includes its unit, whatever the size of a cell. The defaults
    /// describe a small indoor robot for cells of about 1 m; `--robot` chooses another one. The
    /// controller was tuned by a random search over 400 candidates at 20 Hz in cells of 1 m. Its
    /// two gains and the turn were then chosen so that noise 3 causes no wrong outcome (120,000
    /// random moves in three mazes).
    pub struct PhysicsParams {
        /// Noise level. Multiplies the deviations of the wheels and of a measured pose, and all deviations and rates of
        /// the sensors. 0 switches noise off.
        noise: f64 = 1.0, in 0.0..=5.0;
        /// Robot mass m in kg.
        mass_kg: f64 = 5.0, in 0.1..=1000.0;
        /// Robot radius r in m. Half a cell must be at least the radius plus `arrival_m`. With less than 0.1 m of
        /// extra space, noise can push the robot against walls that it drives along.
        radius_m: f64 = 0.3, in 0.02..=2.0;
        /// Distance b between the wheels in m.
        wheel_base_m: f64 = 0.4, in 0.02..=4.0;
        /// Largest wheel acceleration in m/s^2. The wheels slip above mu g, 7.848 m/s^2 on the usual floor, and the
        /// heading is lost.
        wheel_acceleration_mps2: f64 = 7.4, in 0.1..=7.848;
        /// Largest speed in m/s. In cells of 1 m, 20 steps per second are too few to steer above
        /// 1.6 m/s.
        max_speed_mps: f64 = 1.4, in 0.02..=3.0;
        /// Largest turn rate in rad/s.
        max_turn_radps: f64 = 12.0, in 0.1..=15.0;
        /// Sine of the heading correction per metre of distance from the track.
        track_gain_per_m: f64 = 3.2, in 0.5..=8.0;
        /// Deceleration before the target in m/s^2, from 0.05 to `wheel_acceleration_mps2`. Above half of
        /// that, the robot overshoots.
        deceleration_mps2: f64 = 3.09;
        /// Angular deceleration at the end of a turn in rad/s^2.
        turn_deceleration_radps2: f64 = 12.0, in 0.2..=30.0;
        /// Distance from the target in m below which a move can end. The robot must also be slower
        /// than `arrival_mps`.
        arrival_m: f64 = 0.034, in 0.002..=0.2;
        /// Speed in m/s below which a move can end. The robot must also be within `arrival_m`.
        arrival_mps: f64 = 0.57, in 0.01..=2.0;
        /// Sine of the heading error below which a turn can end. The turn rate must also be below
        /// `aligned_radps`.
        aligned: f64 = 0.167, in 0.02..=0.4;
        /// Turn rate in rad/s below which a turn can end. The heading error must also be below
        /// `aligned`.
        aligned_radps: f64 = 1.73, in 0.05..=5.0;
        /// Time limit of an action in s. With the defaults a move takes 1.2 s in a cell of 1 m.
        time_out_s: f64 = 10.0, in 0.05..=600.0;
        /// Relative deviation of the distance that a wheel drives, drawn for each action. The encoders do not measure
        /// it.
        wheel_bias: f64 = 0.05, in 0.0..=0.1;
        /// How the robot is localised: `ground-truth` (its true pose, with noise) or `estimated` (from its sensors).
        /// With the percepts `lidar` and `lidar-position` the pose is always estimated.
        localisation: Localisation = Localisation::GroundTruth;
        /// The lidar.
        lidar: LidarParams = LidarParams::default();
        /// The encoders of the wheels.
        encoders: EncoderParams = EncoderParams::default();
        /// The gyro.
        gyro: GyroParams = GyroParams::default();
        /// The bumpers.
        bumper: BumperParams = BumperParams::default();
        /// The filter that estimates the pose.
        estimator: EstimatorParams = EstimatorParams::default();
        /// Cautious driving.
        cautious: CautiousParams = CautiousParams::default();
        /// Sensor faults.
        faults: FaultParams = FaultParams::default();
    }
    constants {
        /// Integrate steps that touch no wall in closed form. Faster, with bit-identical results.
        shortcut: bool = true;
        /// Deviation of a wheel's scale, drawn for each physics step.
        wheel_noise: f64 = 0.05;
        /// Deviation of a measured coordinate in m.
        position_noise_m: f64 = 0.01;
        /// Deviation of a measured heading in rad.
        heading_noise_rad: f64 = 0.02;
    }
}

/// Friction mu between wheel and floor where the world's `floor` names none: rubber on concrete.
pub(super) const FRICTION: f64 = 0.8;
/// Gravity in m/s^2. It presses the wheels to the floor; the maze itself is flat.
const GRAVITY_MPS2: f64 = 9.81;

impl PhysicsParams {
    /// Returns the declarations of all settings, with each part replaced by its own settings.
    pub fn declared_with_parts() -> Vec<Setting> {
        let parts = [
            LidarParams::declared(),
            EncoderParams::declared(),
            GyroParams::declared(),
            BumperParams::declared(),
            EstimatorParams::declared(),
            CautiousParams::declared(),
            FaultParams::declared(),
        ]
        .concat();
        let is_part = |setting: &Setting| {
            let inside = |part: &Setting| part.key.rsplit_once('.').map(|(of, _)| of);
            parts.iter().any(|part| inside(part) == Some(setting.key))
        };
        let mut own = Self::declared();
        own.retain(|setting| !is_part(setting));
        [own, parts].concat()
    }

    /// Checks the parts, and the settings that depend on other settings.
    fn check_parts(&self) -> Result<(), OutOfRange> {
        let acceleration = self.wheel_acceleration_mps2;
        let deceleration = self.deceleration_mps2;
        within(
            "physics.deceleration_mps2",
            deceleration,
            0.05..=acceleration,
        )?;
        self.lidar.check()?;
        self.encoders.check()?;
        self.gyro.check()?;
        self.bumper.check()?;
        self.estimator.check()?;
        self.cautious.check()?;
        self.faults.check()
    }

    /// Returns the size in metres of the smallest cells that the robot fits into, rounded up to
    /// millimetres.
    ///
    /// The robot drives along the middles of cells. Next to a wall it needs its radius and
    /// `arrival_m`, the distance at which a move counts as finished.
    pub fn least_cell_m(&self) -> f64 {
        // Subtracts slightly more than a rounding error, so that whole millimetres are not rounded
        // up.
        (2.0 * (self.radius_m + self.arrival_m) * 1000.0 - 1e-6).ceil() / 1000.0
    }

    /// Returns the radius in metres of the disc that must stay clear around the way of the robot.
    pub fn needed_m(&self) -> f64 {
        self.radius_m + self.arrival_m
    }

    /// Returns the approximate duration of a move in cells of this size, in seconds. A move is a
    /// quarter turn, the path at full speed, and the time to accelerate and brake.
    pub fn move_time_s(&self, cell_size_m: f64) -> f64 {
        let quarter_s = std::f64::consts::FRAC_PI_2 / self.max_turn_radps;
        let speed = self.max_speed_mps;
        let ramps_s =
            speed / self.deceleration_mps2 + self.max_turn_radps / self.turn_deceleration_radps2;
        quarter_s + cell_size_m / speed + ramps_s / 2.0
    }

    /// Returns the same robot in cautious driving. No value is less gentle than in normal driving.
    pub(super) fn careful(&self) -> Self {
        let care = &self.cautious;
        let gentler = |usual: f64, careful: f64| usual.min(careful);
        Self {
            wheel_acceleration_mps2: gentler(
                self.wheel_acceleration_mps2,
                care.wheel_acceleration_mps2,
            ),
            deceleration_mps2: gentler(self.deceleration_mps2, care.deceleration_mps2),
            turn_deceleration_radps2: gentler(
                self.turn_deceleration_radps2,
                care.turn_deceleration_radps2,
            ),
            ..self.clone()
        }
    }

    /// Returns the robot as its sensors and its onboard computer need to know it, in a maze with
    /// cells of `cell_size_m`.
    pub(super) fn robot(&self, cell_size_m: f64) -> RobotParams {
        RobotParams {
            noise: self.noise,
            cell_size_m,
            wheel_base_m: self.wheel_base_m,
            careful_acceleration_mps2: self.cautious.wheel_acceleration_mps2,
            wheel_bias: self.wheel_bias,
            wheel_noise: self.wheel_noise,
            lidar: self.lidar.clone(),
            encoders: self.encoders.clone(),
            gyro: self.gyro.clone(),
            bumper: self.bumper.clone(),
            estimator: self.estimator.clone(),
            faults: self.faults.clone(),
        }
    }
}

/// Returns the largest acceleration that wheels can apply to a floor of this friction, in m/s^2.
pub(super) fn grip_mps2(friction: f64) -> f64 {
    friction * GRAVITY_MPS2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_defaults_are_in_their_ranges() {
        assert_eq!(PhysicsParams::default().check(), Ok(()));
    }

    /// Returns the JSON pointers of all numbers in a value.
    fn numbers(path: &str, value: &serde_json::Value) -> Vec<String> {
        match value.as_object() {
            Some(object) => object
                .iter()
                .flat_map(|(key, inner)| numbers(&format!("{path}/{key}"), inner))
                .collect(),
            None => value
                .is_number()
                .then(|| path.to_owned())
                .into_iter()
                .collect(),
        }
    }

    #[test]
    fn every_number_has_a_range_and_a_key_of_its_own() {
        let defaults = serde_json::to_value(PhysicsParams::default()).unwrap();
        let mut checked = 0;
        for path in numbers("", &defaults) {
            let mut broken = defaults.clone();
            *broken.pointer_mut(&path).unwrap() = 1e6.into();
            // Integers do not accept fractions.
            if defaults.pointer(&path).unwrap().is_u64() {
                *broken.pointer_mut(&path).unwrap() = 1_000_000_001.into();
            }
            let params: PhysicsParams = serde_json::from_value(broken).unwrap();
            let key = params.check().map_err(|error| error.key);
            let wanted = format!("physics{}", path.replace('/', "."));
            assert_eq!(key, Err(wanted.as_str()));
            checked += 1;
        }
        assert!(checked > 35, "{checked}");
    }

    #[test]
    fn wheels_that_would_slip_are_refused() {
        let params = PhysicsParams {
            wheel_acceleration_mps2: 7.9,
            ..PhysicsParams::default()
        };
        let message = params.check().unwrap_err().to_string();
        assert!(message.contains("wheel_acceleration_mps2"), "{message}");
    }

    #[test]
    fn an_unknown_setting_is_refused() {
        assert!(serde_json::from_str::<PhysicsParams>(r#"{"noize": 0}"#).is_err());
    }
}
