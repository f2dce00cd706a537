//! The settings of robot, controller and noise.

use serde::{Deserialize, Serialize};

use xcs::bounds::{OutOfRange, within};
use xcscr_sensing::{BumperParams, EncoderParams, EstimatorParams, GyroParams, LidarParams, Robot};

/// How the robot knows where it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Localisation {
    /// It is told its true pose with some noise: privileged, as no robot is. For percepts that
    /// are looked up in the maze, and the figures that were made with them.
    #[default]
    Told,
    /// It estimates its pose from its wheels, its gyro and its lidar. Percepts that are sensed
    /// always need that.
    Estimated,
}

/// The robot, its controller and its noise.
///
/// Everything with a length in it is for cells of 1 m and scales with the cell: in a maze of
/// half-metre cells the robot has half the radius and half the speed, and needs as long for a
/// move. The robot is a small indoor one. The controller was found by a random search over 400
/// at 20 Hz; then the two gains and the turn were chosen anew so that even noise 3 causes no
/// wrong outcome (120,000 random moves in three mazes).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PhysicsParams {
    /// Noise level, 0 to 5: multiplies the four deviations below, and all deviations and rates of
    /// the sensors; 0 switches noise off.
    pub noise: f64,
    /// Integrate in closed form while no wall is near? Faster, with the same bits.
    pub shortcut: bool,
    /// Robot mass m in kg, 0.1 to 1000.
    pub mass_kg: f64,
    /// Robot radius r in m, 0.1 to 0.35. With more, noise drives it into the corners of walls.
    pub radius_m: f64,
    /// Distance b between the wheels in m, 0.1 to 0.7.
    pub wheel_base_m: f64,
    /// Friction mu between wheel and floor, 0.2 to 2: rubber on concrete.
    pub friction: f64,
    /// Time constant tau of the motors in s, 0 to 0.1.
    pub motor_lag_s: f64,
    /// Largest wheel acceleration in m/s^2, 1 to mu g. Beyond, the wheels slip and the heading is lost.
    pub wheel_acceleration_mps2: f64,
    /// Largest speed in m/s, 0.3 to 1.6. Beyond, 20 steps per second are too few to steer.
    pub max_speed_mps: f64,
    /// Largest turn rate in rad/s, 0.5 to 15.
    pub max_turn_radps: f64,
    /// Turn rate per heading error in 1/s, 2 to 15. Beyond, it oscillates at 20 Hz.
    pub heading_gain_per_s: f64,
    /// Heading correction (a sine) per metre beside the track, 0.5 to 8.
    pub track_gain_per_m: f64,
    /// Largest heading correction (a sine), 0.05 to 0.7.
    pub track_limit: f64,
    /// Deceleration before the target in m/s^2, 0.5 to what the wheels can do. With more than
    /// half of that, the robot overshoots.
    pub deceleration_mps2: f64,
    /// Angular deceleration at the end of a turn in rad/s^2, 2 to 30.
    pub turn_deceleration_radps2: f64,
    /// The target is reached this close to it, in m, 0.005 to 0.1 ...
    pub arrival_m: f64,
    /// ... and below this speed in m/s, 0.05 to 1.
    pub arrival_mps: f64,
    /// A turn ends with a heading error (a sine) below this, 0.02 to 0.4 ...
    pub aligned: f64,
    /// ... and below this turn rate in rad/s, 0.1 to 5.
    pub aligned_radps: f64,
    /// An action that takes longer is given up, in s, 0.05 to 60. A move takes 1.2 s.
    pub time_out_s: f64,
    /// Deviation of a wheel's scale, drawn for each action, 0 to 0.1.
    pub wheel_bias: f64,
    /// Deviation of a wheel's scale, drawn for each physics step, 0 to 0.1.
    pub wheel_noise: f64,
    /// Deviation of a measured coordinate in m, 0 to 0.03.
    pub position_noise_m: f64,
    /// Deviation of a measured heading in rad, 0 to 0.1.
    pub heading_noise_rad: f64,
    /// How the robot knows where it is: `told` (its true pose with the noise above) or `estimated`.
    pub localisation: Localisation,
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

impl Default for PhysicsParams {
    fn default() -> Self {
        Self {
            noise: 1.0,
            shortcut: true,
            mass_kg: 5.0,
            radius_m: 0.3,
            wheel_base_m: 0.4,
            friction: 0.8,
            motor_lag_s: 0.03,
            wheel_acceleration_mps2: 7.4,
            max_speed_mps: 1.4,
            max_turn_radps: 12.0,
            heading_gain_per_s: 12.5,
            track_gain_per_m: 3.2,
            track_limit: 0.33,
            deceleration_mps2: 3.09,
            turn_deceleration_radps2: 12.0,
            arrival_m: 0.034,
            arrival_mps: 0.57,
            aligned: 0.167,
            aligned_radps: 1.73,
            time_out_s: 10.0,
            wheel_bias: 0.05,
            wheel_noise: 0.05,
            position_noise_m: 0.01,
            heading_noise_rad: 0.02,
            localisation: Localisation::Told,
            lidar: LidarParams::default(),
            encoders: EncoderParams::default(),
            gyro: GyroParams::default(),
            bumper: BumperParams::default(),
            estimator: EstimatorParams::default(),
        }
    }
}

/// Gravity in m/s^2. It presses the wheels to the floor; the maze itself is flat.
const GRAVITY_MPS2: f64 = 9.81;

impl PhysicsParams {
    /// Checks every number against its range.
    ///
    /// # Errors
    /// Names the first setting that lies outside of its range, and the range.
    pub fn check(&self) -> Result<(), OutOfRange> {
        self.check_robot()?;
        self.check_controller()?;
        within("physics.noise", self.noise, 0.0..=5.0)?;
        within("physics.wheel_bias", self.wheel_bias, 0.0..=0.1)?;
        within("physics.wheel_noise", self.wheel_noise, 0.0..=0.1)?;
        let (position, heading) = (self.position_noise_m, self.heading_noise_rad);
        within("physics.position_noise_m", position, 0.0..=0.03)?;
        within("physics.heading_noise_rad", heading, 0.0..=0.1)?;
        self.lidar.check()?;
        self.encoders.check()?;
        self.gyro.check()?;
        self.bumper.check()?;
        self.estimator.check()
    }

    fn check_robot(&self) -> Result<(), OutOfRange> {
        let acceleration = self.wheel_acceleration_mps2;
        let grip = self.grip_mps2();
        within("physics.mass_kg", self.mass_kg, 0.1..=1000.0)?;
        within("physics.radius_m", self.radius_m, 0.1..=0.35)?;
        within("physics.wheel_base_m", self.wheel_base_m, 0.1..=0.7)?;
        within("physics.friction", self.friction, 0.2..=2.0)?;
        within("physics.motor_lag_s", self.motor_lag_s, 0.0..=0.1)?;
        within("physics.wheel_acceleration_mps2", acceleration, 1.0..=grip)
    }

    fn check_controller(&self) -> Result<(), OutOfRange> {
        let checks = [
            ("physics.max_speed_mps", self.max_speed_mps, 0.3..=1.6),
            ("physics.max_turn_radps", self.max_turn_radps, 0.5..=15.0),
            (
                "physics.heading_gain_per_s",
                self.heading_gain_per_s,
                2.0..=15.0,
            ),
            ("physics.track_gain_per_m", self.track_gain_per_m, 0.5..=8.0),
            ("physics.track_limit", self.track_limit, 0.05..=0.7),
            (
                "physics.deceleration_mps2",
                self.deceleration_mps2,
                0.5..=self.wheel_acceleration_mps2,
            ),
            (
                "physics.turn_deceleration_radps2",
                self.turn_deceleration_radps2,
                2.0..=30.0,
            ),
            ("physics.arrival_m", self.arrival_m, 0.005..=0.1),
            ("physics.arrival_mps", self.arrival_mps, 0.05..=1.0),
            ("physics.aligned", self.aligned, 0.02..=0.4),
            ("physics.aligned_radps", self.aligned_radps, 0.1..=5.0),
            ("physics.time_out_s", self.time_out_s, 0.05..=60.0),
        ];
        checks
            .into_iter()
            .try_for_each(|(key, value, range)| within(key, value, range))
    }

    /// The robot as its sensors and its own computer need to know it.
    pub(super) fn robot(&self) -> Robot {
        Robot {
            noise: self.noise,
            wheel_base: self.wheel_base_m,
            wheel_deviation: self.wheel_bias.max(self.wheel_noise),
            lidar: self.lidar.clone(),
            encoders: self.encoders.clone(),
            gyro: self.gyro.clone(),
            bumper: self.bumper.clone(),
            estimator: self.estimator.clone(),
        }
    }

    /// The largest acceleration that the wheels can bring to the floor, in m/s^2.
    pub(super) fn grip_mps2(&self) -> f64 {
        self.friction * GRAVITY_MPS2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_defaults_lie_in_their_ranges() {
        assert_eq!(PhysicsParams::default().check(), Ok(()));
    }

    /// Where the numbers of a value stand, as JSON pointers.
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
            // Whole numbers do not take fractions.
            if defaults.pointer(&path).unwrap().is_u64() {
                *broken.pointer_mut(&path).unwrap() = 1_000_000.into();
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
            friction: 0.4,
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
