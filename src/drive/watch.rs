//! Monitors incoming messages: ages, stamps, frames and values.

use super::fault::Fault;
use super::readings::{Imu, Odometry, Readings, Scan};
use super::timeline::beam_time_ns;
use crate::arena::LidarParams;

const SECOND_NS: f64 = 1e9;
/// The maximum age of odometry in nanoseconds: three control periods.
const ODOMETRY_AGE_NS: u64 = 150_000_000;
/// The longest standstill of simulated time, in real nanoseconds.
const CLOCK_AGE_NS: u64 = 1_000_000_000;
/// The maximum age of scans, in lidar turns.
const TURNS: f64 = 2.0;
/// A change of the stamps by more than this, in nanoseconds, is a jump if less than half of it has
/// passed.
const JUMP_NS: u64 = 500_000_000;
/// The maximum difference between the stamps of scans and odometry, in nanoseconds.
const DISAGREEMENT_NS: u64 = 1_000_000_000;
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

/// The last message of a topic.
#[derive(Debug, Clone, Copy)]
struct Seen {
    stamp_ns: u64,
    arrived_ns: u64,
}

/// Monitors incoming messages.
#[derive(Debug)]
pub struct Watch {
    lidar: LidarParams,
    frames: Frames,
    begun_ns: Option<u64>,
    scan: Option<Seen>,
    odometry: Option<Seen>,
    /// Simulated time, and the time on the steady clock when it last changed.
    clock: Option<(u64, u64)>,
    /// The fault of the last message of each topic.
    scan_fault: Option<Fault>,
    odometry_fault: Option<Fault>,
    jump: Option<Fault>,
}

/// The usable readings, and the faults.
#[derive(Debug, Default)]
pub struct Watched<'a> {
    pub scans: Vec<&'a Scan>,
    pub odometry: Vec<&'a Odometry>,
    pub imu: Vec<&'a Imu>,
    pub faults: Vec<Fault>,
}

impl Watch {
    /// Creates a monitor for a robot with this lidar and these frames.
    pub fn new(lidar: &LidarParams, frames: Frames) -> Self {
        Self {
            lidar: lidar.clone(),
            frames,
            begun_ns: None,
            scan: None,
            odometry: None,
            clock: None,
            scan_fault: None,
            odometry_fault: None,
            jump: None,
        }
    }

    /// Checks the readings that arrived until `steady_ns`, a clock that never jumps.
    pub fn step<'a>(&mut self, steady_ns: u64, readings: &'a Readings) -> Watched<'a> {
        let now_ns = self.now(steady_ns, readings.clock_ns);
        let begun_ns = *self.begun_ns.get_or_insert(now_ns);
        let mut watched = Watched::default();
        for odometry in &readings.odometry {
            if self.accepts_odometry(odometry, now_ns) {
                watched.odometry.push(odometry);
            }
        }
        watched.imu = readings.imu.iter().collect();
        watched.imu.retain(|imu| imu.turn_radps.is_finite());
        for scan in &readings.scans {
            if self.accepts_scan(scan, now_ns) {
                watched.scans.push(scan);
            }
        }
        let age = |seen: Option<Seen>| {
            let since_ns = seen.map_or(begun_ns, |seen| seen.arrived_ns);
            now_ns.saturating_sub(since_ns)
        };
        let (scan_ns, odometry_ns) = (age(self.scan), age(self.odometry));
        let faults = &mut watched.faults;
        if scan_ns as f64 > TURNS * SECOND_NS / self.lidar.rate_hz {
            faults.push(Fault::NoScans(scan_ns as f64 / SECOND_NS));
        }
        if odometry_ns > ODOMETRY_AGE_NS {
            faults.push(Fault::NoOdometry(odometry_ns as f64 / SECOND_NS));
        }
        let stood = |(_, changed_ns): (u64, u64)| steady_ns.saturating_sub(changed_ns);
        if let Some(stood_ns) = self.clock.map(stood).filter(|&ns| ns > CLOCK_AGE_NS) {
            faults.push(Fault::NoClock(stood_ns as f64 / SECOND_NS));
        }
        let of_messages = [&self.jump, &self.odometry_fault, &self.scan_fault];
        faults.extend(of_messages.into_iter().flatten().cloned());
        of_network(readings, faults);
        watched
    }

    /// Returns the time for measuring ages: simulated time if there is any, otherwise the steady
    /// clock.
    fn now(&mut self, steady_ns: u64, clock_ns: Option<u64>) -> u64 {
        let Some(clock_ns) = clock_ns else {
            return self.clock.map_or(steady_ns, |(clock_ns, _)| clock_ns);
        };
        let (last_ns, changed_ns) = self.clock.unwrap_or((clock_ns, steady_ns));
        if clock_ns < last_ns {
            self.jumped("/clock", last_ns, clock_ns);
        }
        let changed_ns = if clock_ns > last_ns {
            steady_ns
        } else {
            changed_ns
        };
        if self.clock.is_none() {
            // Restart ages that were measured with the steady clock.
            self.begun_ns = None;
            let again = |seen: Seen| Seen {
                arrived_ns: clock_ns,
                ..seen
            };
            self.scan = self.scan.map(again);
            self.odometry = self.odometry.map(again);
        }
        self.clock = Some((clock_ns.max(last_ns), changed_ns));
        clock_ns.max(last_ns)
    }

    fn jumped(&mut self, topic: &'static str, from_ns: u64, to_ns: u64) {
        let by_s = (to_ns as f64 - from_ns as f64) / SECOND_NS;
        self.jump.get_or_insert(Fault::ClockJumped { topic, by_s });
    }

    /// Tracks the stamps of a topic. Returns false for a message that is not newer than the last
    /// one.
    fn follow(&mut self, topic: &'static str, last: Option<Seen>, now: Seen) -> bool {
        let Some(last) = last else {
            return true;
        };
        let step_ns = now.stamp_ns.saturating_sub(last.stamp_ns);
        let passed_ns = now.arrived_ns.saturating_sub(last.arrived_ns);
        if now.stamp_ns < last.stamp_ns || (step_ns > JUMP_NS && passed_ns < step_ns / 2) {
            self.jumped(topic, last.stamp_ns, now.stamp_ns);
        }
        now.stamp_ns > last.stamp_ns
    }

    fn accepts_odometry(&mut self, odometry: &Odometry, arrived_ns: u64) -> bool {
        self.odometry_fault = self.fault_of_odometry(odometry);
        if self.odometry_fault.is_some() {
            return false;
        }
        let seen = Seen {
            stamp_ns: odometry.stamp_ns,
            arrived_ns,
        };
        let is_newer = self.follow("/odom", self.odometry, seen);
        if is_newer {
            self.odometry = Some(seen);
        }
        is_newer
    }

    fn fault_of_odometry(&self, odometry: &Odometry) -> Option<Fault> {
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
        frame_fault(topic, &odometry.frame, std::slice::from_ref(odom))
            .or_else(|| frame_fault(topic, &odometry.child_frame, base))
    }

    fn accepts_scan(&mut self, scan: &Scan, arrived_ns: u64) -> bool {
        self.scan_fault = self.fault_of_scan(scan, arrived_ns);
        if self.scan_fault.is_some() {
            return false;
        }
        let seen = Seen {
            stamp_ns: scan.stamp_ns,
            arrived_ns,
        };
        let is_newer = self.follow("/scan", self.scan, seen);
        if is_newer {
            self.scan = Some(seen);
        }
        is_newer
    }

    fn fault_of_scan(&self, scan: &Scan, arrived_ns: u64) -> Option<Fault> {
        let beams = scan.ranges_m.len();
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
        let expected = self.lidar.beams as usize;
        if beams.abs_diff(expected) > BEAMS {
            return Some(Fault::WrongLidar {
                what: "beams",
                found: beams as f64,
                expected: expected as f64,
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
        if let Some(odometry) = self.odometry
            && scan.stamp_ns.abs_diff(odometry.stamp_ns) > DISAGREEMENT_NS
        {
            let by_s = (scan.stamp_ns as f64 - odometry.stamp_ns as f64) / SECOND_NS;
            return Some(Fault::ClocksDisagree(by_s));
        }
        if let Some(odometry) = self.odometry {
            let passed_ns = arrived_ns.saturating_sub(odometry.arrived_ns);
            let last_ns = beam_time_ns(scan, beams - 1);
            let ahead_ns = last_ns.saturating_sub(odometry.stamp_ns + passed_ns);
            if ahead_ns > ODOMETRY_AGE_NS {
                return Some(Fault::ScanAhead(ahead_ns as f64 / SECOND_NS));
            }
        }
        frame_fault("/scan", &scan.frame, &self.frames.scan)
    }
}

fn frame_fault(topic: &'static str, found: &str, expected: &[String]) -> Option<Fault> {
    // ROS 1 nodes and some drivers prefix frames with a slash.
    let found_name = found.strip_prefix('/').unwrap_or(found);
    let is_expected = expected.iter().any(|name| name == found_name);
    (!is_expected).then(|| Fault::WrongFrame {
        topic,
        found: found.to_owned(),
        expected: format!("`{}`", expected.join("` or `")),
    })
}

fn of_network(readings: &Readings, faults: &mut Vec<Fault>) {
    let network = &readings.network;
    if network.other_publishers > 0 {
        faults.push(Fault::OtherPublisher(network.other_publishers));
    }
    let incompatible = network.incompatible.iter();
    faults.extend(incompatible.map(|(topic, cause)| Fault::WrongQos {
        topic: topic.clone(),
        cause: cause.clone(),
    }));
}
