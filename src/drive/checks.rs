//! Checks the values of a message before they are used.

use nalgebra::Isometry2;

use super::fault::Fault;
use super::readings::{Imu, Odometry, Scan};
use crate::arena::{LidarParams, PhysicsParams, Speeds};

const SECOND_NS: f64 = 1e9;
/// The maximum difference between the stamps of two topics, in nanoseconds.
const DISAGREEMENT_NS: u64 = 1_000_000_000;
/// The speeds that are possible, as a multiple of the largest commanded ones. Wheels overshoot, and
/// hands turn a robot.
const FASTER: f64 = 3.0;
/// The distance in metres and the turn in radians that odometry may be off between two messages, beside
/// the way at a possible speed.
const ODOMETRY_STEP: [f64; 2] = [0.05, 0.2];
/// The longest time in nanoseconds for which a way between two messages is possible. After it the
/// robot has stopped by its own time-out.
const MOST_WAY_NS: u64 = 1_000_000_000;
/// The maximum share of ranges that are not a number.
const INVALID: f64 = 0.5;
/// The least share of the beams of a scan that return. A lidar that is covered returns nothing.
const LEAST_RETURNS: f64 = 0.02;
/// The most that the time between beams may exceed that of the profile. A lidar that does not turn reports
/// infinity.
const SLOWEST: f64 = 10.0;
/// The maximum differences of the lidar from the profile: in range, as a share, and in beams per
/// turn.
const RANGE_SHARE: f64 = 0.05;
const BEAMS: usize = 2;

/// The expected frames of messages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frames {
    /// The frame of odometry.
    pub odom: String,
    /// The accepted frames of the robot.
    pub base: Vec<String>,
    /// The accepted frames of the lidar.
    pub scan: Vec<String>,
}

impl Default for Frames {
    /// Returns the frames of REP 105 and of TurtleBots.
    fn default() -> Self {
        let owned = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
        Self {
            odom: "odom".to_owned(),
            base: owned(&["base_link", "base_footprint"]),
            scan: owned(&["base_scan", "laser", "laser_frame", "base_link"]),
        }
    }
}

/// The values of messages that are possible for a robot.
#[derive(Debug)]
pub struct Checks {
    lidar: LidarParams,
    /// The largest possible speeds.
    fastest: Speeds,
    /// The largest turn rate that the gyro measures.
    gyro_radps: f64,
    frames: Frames,
}

impl Checks {
    /// Creates the checks for a robot with these settings and these frames.
    pub fn new(physics: &PhysicsParams, frames: Frames) -> Self {
        Self {
            lidar: physics.lidar.clone(),
            fastest: Speeds {
                forward_mps: FASTER * physics.max_speed_mps,
                turn_radps: FASTER * physics.max_turn_radps,
            },
            gyro_radps: physics.gyro.range_radps,
            frames,
        }
    }

    /// Returns what is wrong with the values of odometry.
    pub fn odometry(&self, odometry: &Odometry) -> Option<Fault> {
        let topic = "/odom";
        let (at, speeds) = (odometry.pose.translation, odometry.speeds);
        let heading = odometry.pose.rotation;
        let numbers = [
            at.x,
            at.y,
            heading.re,
            heading.im,
            speeds.forward_mps,
            speeds.turn_radps,
        ];
        if !numbers.iter().all(|number| number.is_finite()) {
            return Some(Fault::InvalidOdometry);
        }
        let Frames { odom, base, .. } = &self.frames;
        of_frame(topic, &odometry.frame, std::slice::from_ref(odom))
            .or_else(|| of_frame(topic, &odometry.child_frame, base))
    }

    /// Returns the fault of a robot that moves faster than it can. `last` is the stamp of the message
    /// before, in nanoseconds, and the last accepted pose.
    pub fn motion(
        &self,
        odometry: &Odometry,
        last: Option<(u64, Isometry2<f64>)>,
    ) -> Option<Fault> {
        let Speeds {
            forward_mps,
            turn_radps,
        } = self.fastest;
        let speeds = odometry.speeds;
        let mut found = vec![
            ("the speed in m/s", speeds.forward_mps, forward_mps),
            ("the turn rate in rad/s", speeds.turn_radps, turn_radps),
        ];
        if let Some((last_ns, pose)) = last {
            let passed_ns = odometry.stamp_ns.saturating_sub(last_ns);
            let passed_s = passed_ns.min(MOST_WAY_NS) as f64 / SECOND_NS;
            let moved = pose.inverse() * odometry.pose;
            let (way_m, turned_rad) = (moved.translation.vector.norm(), moved.rotation.angle());
            let most_m = ODOMETRY_STEP[0] + passed_s * forward_mps;
            let most_rad = ODOMETRY_STEP[1] + passed_s * turn_radps;
            found.push(("the way in m since the last message", way_m, most_m));
            found.push((
                "the turn in rad since the last message",
                turned_rad,
                most_rad,
            ));
        }
        let found = found
            .into_iter()
            .find(|(_, value, most)| value.abs() > *most);
        found.map(|(what, found, most)| Fault::ImpossibleOdometry { what, found, most })
    }

    /// Returns what is wrong with a gyro reading.
    pub fn imu(&self, imu: &Imu) -> Option<Fault> {
        let is_possible = imu.turn_radps.abs() <= self.gyro_radps;
        (!is_possible).then_some(Fault::InvalidImu(imu.turn_radps))
    }

    /// Returns what is wrong with the values of a scan.
    pub fn scan(&self, scan: &Scan) -> Option<Fault> {
        let beams = scan.ranges_m.len();
        let expected = self.lidar.beams as usize;
        if beams > 0 && beams.abs_diff(expected) > BEAMS {
            return Some(Fault::WrongLidar {
                what: "beams",
                found: beams as f64,
                expected: expected as f64,
            });
        }
        let invalid = scan.ranges_m.iter().filter(|range| range.is_nan()).count();
        if invalid as f64 > INVALID * beams as f64 || beams == 0 {
            return Some(Fault::InvalidRanges(invalid as f64 / beams.max(1) as f64));
        }
        let expected = 1.0 / (self.lidar.rate_hz * f64::from(self.lidar.beams));
        let found = scan.time_increment_s;
        if !found.is_finite() || found > SLOWEST * expected {
            let what = "time_increment";
            return Some(Fault::WrongLidar {
                what,
                found,
                expected,
            });
        }
        let expected = self.lidar.range_m;
        if (scan.range_max_m - expected).abs() > RANGE_SHARE * expected {
            return Some(Fault::WrongLidar {
                what: "range_max",
                found: scan.range_max_m,
                expected,
            });
        }
        let returns = (0..beams).filter(|beam| scan.measured_m(*beam).is_some());
        let returns = returns.count();
        if returns == 0 || (returns as f64) < LEAST_RETURNS * beams as f64 {
            return Some(Fault::NoReturns(returns));
        }
        of_frame("/scan", &scan.frame, &self.frames.scan)
    }
}

/// Returns the fault of a stamp of a topic that is far from a stamp of another one.
pub fn of_stamps([topic, other]: [&'static str; 2], stamp_ns: u64, other_ns: u64) -> Option<Fault> {
    let by_s = (stamp_ns as f64 - other_ns as f64) / SECOND_NS;
    let is_far = stamp_ns.abs_diff(other_ns) > DISAGREEMENT_NS;
    is_far.then_some(Fault::ClocksDisagree { topic, other, by_s })
}

fn of_frame(topic: &'static str, found: &str, expected: &[String]) -> Option<Fault> {
    // ROS 1 nodes and some drivers prefix frames with a slash.
    let found_name = found.strip_prefix('/').unwrap_or(found);
    let is_expected = expected.iter().any(|name| name == found_name);
    (!is_expected).then(|| Fault::WrongFrame {
        topic,
        found: found.to_owned(),
        expected: format!("`{}`", expected.join("` or `")),
    })
}
