//! Checks the values of a message before they are used.

use std::f64::consts::TAU;

use nalgebra::Isometry2;

use super::fault::Fault;
use super::readings::{Imu, Odometry, Scan};
use crate::arena::{PhysicsParams, Speeds};

const SECOND_NS: f64 = 1e9;
/// The maximum difference between the stamps of two topics, in nanoseconds.
const DISAGREEMENT_NS: u64 = 1_000_000_000;
/// The speeds that are possible, as a multiple of the largest commanded ones. Wheels overshoot, and
/// hands turn a robot.
pub const FASTER: f64 = 3.0;
/// The distance in metres and the turn in radians that odometry may be off between two messages, beside
/// the way at a possible speed.
pub const STEP_M: f64 = 0.05;
const STEP_RAD: f64 = 0.2;
/// The longest time in nanoseconds for which a way between two messages is possible. After it the
/// robot has stopped by its own time-out.
pub const MOST_WAY_NS: u64 = 1_000_000_000;
/// The maximum share of ranges that are not a number.
const INVALID: f64 = 0.5;
/// The least share of the beams of a scan that return where there are walls. A lidar that is covered
/// returns nothing.
const LEAST_RETURNS: f64 = 0.02;
/// The numbers of beams of a scan. More would delay the next command.
const BEAMS: [f64; 2] = [16.0, 10_000.0];
/// The angle of all beams in turns. Drivers leave out some beams, or repeat the first one.
const TURNS: [f64; 2] = [0.9, 1.1];
/// The longest time of a scan, in turns of the profile's lidar.
const LONGEST_TURN: f64 = 2.0;

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
    /// The number of beams of the profile.
    beams: f64,
    longest_turn_s: f64,
    /// The distance of the nearest walls from the middle of a cell.
    nearest_wall_m: f64,
    /// The range that the percept of the policy needs.
    needed_range_m: f64,
    /// The largest possible speeds.
    fastest: Speeds,
    /// The largest turn rate that the gyro measures.
    gyro_radps: f64,
    frames: Frames,
}

impl Checks {
    /// Creates the checks for a robot with these settings, in cells of this size, and these frames.
    pub fn new(physics: &PhysicsParams, cell_size_m: f64, frames: Frames) -> Self {
        let lidar = &physics.lidar;
        let in_cells = lidar.range_m / lidar.largest_cell_m();
        Self {
            beams: lidar.beams.into(),
            longest_turn_s: LONGEST_TURN / lidar.rate_hz,
            nearest_wall_m: cell_size_m / 2.0,
            // A beam that does not come back counts as free as far as this.
            needed_range_m: lidar
                .lost_beam_range_m(cell_size_m)
                .max((in_cells * cell_size_m).min(lidar.range_m)),
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
            let most_m = STEP_M + passed_s * forward_mps;
            let most_rad = STEP_RAD + passed_s * turn_radps;
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

    /// Returns what is wrong with the values of a scan. `sees_walls` returns true if there are walls in
    /// its range.
    pub fn scan(&self, scan: &Scan, sees_walls: &dyn Fn() -> bool) -> Option<Fault> {
        let beams = scan.ranges_m.len();
        let all = beams as f64;
        let turns = all * scan.angle_increment_rad.abs() / TAU;
        let turn_s = all * scan.time_increment_s;
        let [least_beams, most_beams] = BEAMS;
        let limits = [
            (
                "number of beams",
                all,
                [least_beams.min(self.beams), most_beams],
            ),
            (
                "size of angle_min in rad",
                scan.angle_min_rad.abs(),
                [0.0, 2.0 * TAU],
            ),
            ("angle of all beams in turns", turns, TURNS),
            ("time of all beams in s", turn_s, [0.0, self.longest_turn_s]),
            (
                "range_min in m",
                scan.range_min_m,
                [0.0, self.nearest_wall_m],
            ),
            (
                "range_max in m",
                scan.range_max_m,
                [self.needed_range_m, f64::INFINITY],
            ),
        ];
        let is_wrong =
            |(_, found, [least, most]): &(_, f64, [f64; 2])| !(least..=most).contains(&found);
        if let Some((what, found, [least, most])) = limits.into_iter().find(is_wrong) {
            return Some(Fault::WrongLidar {
                what,
                found,
                least,
                most,
            });
        }
        let invalid = scan.ranges_m.iter().filter(|range| range.is_nan()).count();
        if invalid as f64 > INVALID * all {
            return Some(Fault::InvalidRanges(invalid as f64 / all));
        }
        let returns = (0..beams).filter(|beam| scan.measured_m(*beam).is_some());
        let returns = returns.count();
        let is_empty = returns == 0 || (returns as f64) < LEAST_RETURNS * all;
        (is_empty && sees_walls()).then_some(Fault::NoReturns(returns))
    }
}

impl Frames {
    /// Returns the frames with a prefix before each name.
    #[must_use]
    pub fn with_prefix(self, prefix: &str) -> Self {
        let all = |names: Vec<String>| names.iter().map(|name| format!("{prefix}{name}")).collect();
        Self {
            odom: format!("{prefix}{}", self.odom),
            base: all(self.base),
            scan: all(self.scan),
        }
    }

    /// Returns what is wrong with the frame of a scan.
    pub(super) fn fault_of_scan(&self, found: &str) -> Option<Fault> {
        of_frame("/scan", found, &self.scan)
    }
}

/// Returns the fault of a stamp of a topic that is far from a stamp of another one.
pub fn of_stamps([topic, other]: [&'static str; 2], stamp_ns: u64, other_ns: u64) -> Option<Fault> {
    let by_s = (stamp_ns as f64 - other_ns as f64) / SECOND_NS;
    let is_far = stamp_ns.abs_diff(other_ns) > DISAGREEMENT_NS;
    is_far.then_some(Fault::ClocksDisagree { topic, other, by_s })
}

fn of_frame(topic: &'static str, found: &str, expected: &[String]) -> Option<Fault> {
    let is_expected = expected.iter().any(|name| name == without_slash(found));
    (!is_expected).then(|| Fault::WrongFrame {
        topic,
        found: found.to_owned(),
        expected: format!("`{}`", expected.join("` or `")),
    })
}

/// Returns the name of a frame. ROS 1 nodes and some drivers begin it with a slash.
pub fn without_slash(frame: &str) -> &str {
    frame.strip_prefix('/').unwrap_or(frame)
}
