//! Compares the profile of a robot with a recorded drive: which values disagree, and by how much.
//!
//! The driver repeats the drive, so its filter says where the robot was. Each value is then fitted to
//! the recording: the motors to the commands, odometry and ranges to the map.

mod motors;
mod odometry;
mod ranges;
mod squares;

use nalgebra::Isometry2;
use xcscr_sensing::Return;

use self::ranges::Ranges;
use super::bag::DriveRecording;
use super::driver::{Driver, Sensed};
use super::setup::DriveSetup;
use crate::arena::{LidarParams, PhysicsParams, Speeds};
use crate::world::Maze;

/// The half width of an interval in standard errors.
const ERRORS: f64 = 3.0;
/// The difference that is accepted beside the interval, as a share of the profile's value: what the
/// simulation simplifies.
const ACCEPTED: f64 = 0.05;
/// The lag in seconds that is accepted.
const ACCEPTED_LAG_S: f64 = 0.01;
/// The longest way in m of a wheel in a step at rest: 1 cm/s.
const REST_M: f64 = 0.0005;
/// The most beams of one rest that are compared.
const MOST_BEAMS: usize = 2_000;

/// A value that was found in a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// The value.
    pub value: f64,
    /// Half of the width of its interval: three standard errors.
    pub within: f64,
}

impl Found {
    fn new(value: f64, error: f64) -> Self {
        Self {
            value,
            within: ERRORS * error,
        }
    }
}

/// A value of a profile, and what a recording says about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Compared {
    /// The name of the setting, or `lag_s`: the seconds between a command and its effect, beside the
    /// time of the simulated motors.
    pub name: &'static str,
    /// The value of the profile.
    pub profile: f64,
    /// The value in the recording; `None` if it shows too little.
    pub found: Option<Found>,
    /// True if they differ by more than the interval and what is accepted beside it.
    pub differs: bool,
}

/// A step of the onboard computer.
struct Step {
    end_ns: u64,
    rolled_m: [f64; 2],
    /// The pose by the filter at the end.
    pose: Isometry2<f64>,
    /// The number of rests before. Errors of steps between two rests may be in common.
    group: usize,
}

/// The steps of a drive, and its rests.
#[derive(Default)]
struct Gathered {
    steps: Vec<Step>,
    rests: usize,
    ranges: Ranges,
    /// The current rest: whether there is one, its beams, and the pose.
    is_still: bool,
    beams: Vec<Return>,
    pose: Isometry2<f64>,
}

/// Compares a robot's profile with a recorded drive. The setup is that of the driver: it has the
/// profile, the map and the start.
pub fn compare(setup: DriveSetup, recording: &DriveRecording) -> Vec<Compared> {
    let (maze, physics) = (setup.maze.clone(), setup.physics.clone());
    let mut gathered = Gathered::default();
    let mut driver = Driver::new(setup);
    let mut sent = recording.commands.iter().peekable();
    let mut commands = Vec::new();
    // The time of the recording and of the robot at the last odometry.
    let mut clocks = None;
    for (time_ns, readings) in &recording.readings {
        driver.step(*time_ns, readings);
        for step in driver.sensed() {
            gathered.add(step, &maze, &physics.lidar);
        }
        let odometry = readings.odometry.last();
        clocks = odometry.map(|it| (*time_ns, it.stamp_ns)).or(clocks);
        while let Some((sent_ns, speeds)) = sent.next_if(|(sent_ns, _)| sent_ns <= time_ns) {
            if let Some((at_ns, stamp_ns)) = clocks {
                commands.push((stamp_ns + sent_ns.saturating_sub(at_ns), *speeds));
            }
        }
    }
    gathered.end_rest(&maze, &physics.lidar);
    gathered.compared(&commands, &physics)
}

impl Gathered {
    fn add(&mut self, step: &Sensed, maze: &Maze, lidar: &LidarParams) {
        if step.rolled_m.iter().any(|way_m| way_m.abs() > REST_M) {
            self.end_rest(maze, lidar);
        } else {
            self.is_still = true;
            self.pose = step.pose;
            let room = MOST_BEAMS.saturating_sub(self.beams.len());
            self.beams.extend(step.beams.iter().take(room));
        }
        self.steps.push(Step {
            end_ns: step.end_ns,
            rolled_m: step.rolled_m,
            pose: step.pose,
            group: self.rests,
        });
    }

    fn end_rest(&mut self, maze: &Maze, lidar: &LidarParams) {
        if std::mem::take(&mut self.is_still) {
            self.ranges
                .add(self.rests, maze, &self.pose, &self.beams, lidar);
            self.rests += 1;
        }
        self.beams.clear();
    }

    fn compared(&self, commands: &[(u64, Speeds)], physics: &PhysicsParams) -> Vec<Compared> {
        let lidar = &physics.lidar;
        let [speed, turn, acceleration, lag] = motors::values(&self.steps, commands, physics);
        let [scale, drift] = odometry::values(&self.steps, commands, physics);
        let [noise, share, lost] = self.ranges.values(lidar);
        // The profile has the deviation of the scales of many robots, and the drive the scale of one.
        let of_one = scale.map(|found| Found {
            value: found.value.abs(),
            ..found
        });
        let deviation = physics.encoders.scale;
        let usual = |name, profile: f64, found| compared(name, profile, found, ACCEPTED * profile);
        vec![
            usual("physics.max_speed_mps", physics.max_speed_mps, speed),
            usual("physics.max_turn_radps", physics.max_turn_radps, turn),
            usual(
                "physics.wheel_acceleration_mps2",
                physics.wheel_acceleration_mps2,
                acceleration,
            ),
            compared("lag_s", 0.0, lag, ACCEPTED_LAG_S),
            compared(
                "physics.encoders.scale",
                deviation,
                of_one,
                (ERRORS - 1.0) * deviation,
            ),
            usual("physics.wheel_bias", physics.wheel_bias, drift),
            usual("physics.lidar.noise_m", lidar.noise_m, noise),
            usual("physics.lidar.noise_share", lidar.noise_share, share),
            usual("physics.lidar.dropouts", lidar.dropouts, lost),
        ]
    }
}

/// Compares a value with what was found.
fn compared(name: &'static str, profile: f64, found: Option<Found>, accepted: f64) -> Compared {
    let differs = |found: &Found| (found.value - profile).abs() > found.within + accepted;
    Compared {
        name,
        profile,
        differs: found.as_ref().is_some_and(differs),
        found,
    }
}
