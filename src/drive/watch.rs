//! Monitors incoming messages: ages, stamps, frames and values.

use nalgebra::Isometry2;

use super::checks::{Checks, of_stamps};
use super::fault::Fault;
use super::mounting::{MountedScan, Mounting};
use super::readings::{Imu, Odometry, Readings, Scan};
use super::setup::DriveSetup;
use super::timeline::{MOST_LAG_NS, beam_time_ns};
use crate::trial::ScanOrder;

const SECOND_NS: f64 = 1e9;
/// The maximum age of odometry in nanoseconds: three control periods.
const ODOMETRY_AGE_NS: u64 = 150_000_000;
/// The longest standstill of simulated time, in real nanoseconds.
const CLOCK_AGE_NS: u64 = 1_000_000_000;
/// The maximum age of scans, in lidar turns.
const TURNS: f64 = 2.0;
/// A change of the stamps by more than this, in nanoseconds, is a jump if less than half of it has
/// passed. A change of odometry by more than [`MOST_LAG_NS`] always is one: the
/// onboard computer would catch up in steps of 50 ms.
const JUMP_NS: u64 = 500_000_000;
/// The maximum age of the last beam of a scan that arrives, in nanoseconds.
const SCAN_AGE_NS: u64 = 500_000_000;
/// The last message of a topic.
#[derive(Debug, Clone, Copy)]
struct Seen {
    stamp_ns: u64,
    arrived_ns: u64,
}

/// Monitors incoming messages.
#[derive(Debug)]
pub struct Watch {
    checks: Checks,
    mounting: Mounting,
    order: ScanOrder,
    /// The longest range of the profile's lidar.
    range_m: f64,
    /// The maximum age of scans.
    most_scan_ns: u64,
    begun_ns: Option<u64>,
    scan: Option<Seen>,
    odometry: Option<Seen>,
    /// The stamp of the last odometry, accepted or not, and the last accepted pose.
    pose: Option<(u64, Isometry2<f64>)>,
    /// Simulated time, and the time on the steady clock when it last changed.
    clock: Option<(u64, u64)>,
    /// The fault of the last message of each topic.
    scan_fault: Option<Fault>,
    odometry_fault: Option<Fault>,
    imu_fault: Option<Fault>,
    jump: Option<Fault>,
}

/// The usable readings, and the faults.
#[derive(Debug, Default)]
pub struct Watched<'a> {
    pub scans: Vec<MountedScan>,
    pub odometry: Vec<&'a Odometry>,
    pub imu: Vec<&'a Imu>,
    pub faults: Vec<Fault>,
}

impl Watch {
    /// Creates a monitor for the robot of a drive.
    pub fn new(setup: &DriveSetup) -> Self {
        let (physics, frames) = (&setup.physics, &setup.frames);
        let cell_size_m = setup.maze.cell_size_m();
        Self {
            checks: Checks::new(physics, cell_size_m, frames.clone()),
            mounting: Mounting::new(setup.laser_in_base, frames.clone()),
            order: setup.scan_order,
            range_m: physics.lidar.range_m,
            most_scan_ns: (TURNS * SECOND_NS / physics.lidar.rate_hz) as u64,
            pose: None,
            begun_ns: None,
            scan: None,
            odometry: None,
            clock: None,
            scan_fault: None,
            odometry_fault: None,
            imu_fault: None,
            jump: None,
        }
    }

    /// Checks the readings that arrived until `steady_ns`, a clock that never jumps. `sees_walls` returns
    /// true if there are walls in the range of the lidar.
    pub fn step<'a>(
        &mut self,
        steady_ns: u64,
        readings: &'a Readings,
        sees_walls: &dyn Fn() -> bool,
    ) -> Watched<'a> {
        let now_ns = self.now(steady_ns, readings.clock_ns);
        let begun_ns = *self.begun_ns.get_or_insert(now_ns);
        let mut watched = Watched::default();
        for odometry in &readings.odometry {
            if self.accepts_odometry(odometry, now_ns) {
                watched.odometry.push(odometry);
            }
        }
        for imu in &readings.imu {
            if self.accepts_imu(imu) {
                watched.imu.push(imu);
            }
        }
        for transform in &readings.static_transforms {
            self.mounting.add(transform);
        }
        for scan in &readings.scans {
            let accepted = self.accepted(scan, now_ns, sees_walls);
            watched.scans.extend(accepted);
        }
        let age = |seen: Option<Seen>| {
            let since_ns = seen.map_or(begun_ns, |seen| seen.arrived_ns);
            now_ns.saturating_sub(since_ns)
        };
        let (scan_ns, odometry_ns) = (age(self.scan), age(self.odometry));
        let faults = &mut watched.faults;
        if scan_ns > self.most_scan_ns {
            faults.push(Fault::NoScans(scan_ns as f64 / SECOND_NS));
        }
        if odometry_ns > ODOMETRY_AGE_NS {
            faults.push(Fault::NoOdometry(odometry_ns as f64 / SECOND_NS));
        }
        let stood = |(_, changed_ns): (u64, u64)| steady_ns.saturating_sub(changed_ns);
        if let Some(stood_ns) = self.clock.map(stood).filter(|&ns| ns > CLOCK_AGE_NS) {
            faults.push(Fault::NoClock(stood_ns as f64 / SECOND_NS));
        }
        let of_messages = [
            &self.jump,
            &self.odometry_fault,
            &self.imu_fault,
            &self.scan_fault,
        ];
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
    /// one, or much newer: by more than `most_ns`, or than the time that has passed.
    fn follow(&mut self, topic: &'static str, last: Option<Seen>, now: Seen, most_ns: u64) -> bool {
        let Some(last) = last else {
            return true;
        };
        let step_ns = now.stamp_ns.saturating_sub(last.stamp_ns);
        let passed_ns = now.arrived_ns.saturating_sub(last.arrived_ns);
        let has_jumped = now.stamp_ns < last.stamp_ns
            || step_ns > most_ns
            || (step_ns > JUMP_NS && passed_ns < step_ns / 2);
        if has_jumped {
            self.jumped(topic, last.stamp_ns, now.stamp_ns);
        }
        now.stamp_ns > last.stamp_ns && !has_jumped
    }

    fn accepts_odometry(&mut self, odometry: &Odometry, arrived_ns: u64) -> bool {
        let stamp_ns = odometry.stamp_ns;
        let off_clock = |(clock_ns, _)| of_stamps(["/odom", "/clock"], stamp_ns, clock_ns);
        self.odometry_fault = self
            .checks
            .odometry(odometry)
            .or_else(|| self.clock.and_then(off_clock));
        let seen = Seen {
            stamp_ns,
            arrived_ns,
        };
        if self.odometry_fault.is_some() || !self.follow("/odom", self.odometry, seen, MOST_LAG_NS)
        {
            return false;
        }
        self.odometry_fault = self.checks.motion(odometry, self.pose);
        if self.odometry_fault.is_some() {
            // The time that a jump has lasted does not make it possible.
            self.pose = self.pose.map(|(_, pose)| (stamp_ns, pose));
            return false;
        }
        (self.odometry, self.pose) = (Some(seen), Some((stamp_ns, odometry.pose)));
        true
    }

    /// Accepts a gyro reading after the first odometry, because its time needs another one.
    fn accepts_imu(&mut self, imu: &Imu) -> bool {
        let Some(odometry) = self.odometry else {
            return false;
        };
        let off_clock = || of_stamps(["/imu", "/odom"], imu.stamp_ns, odometry.stamp_ns);
        self.imu_fault = self.checks.imu(imu).or_else(off_clock);
        self.imu_fault.is_none()
    }

    /// Accepts a scan after the first odometry, because its beams need the poses of the robot. Returns it
    /// in chronological order, without ranges that the robot of the policy cannot measure.
    fn accepted(
        &mut self,
        scan: &Scan,
        arrived_ns: u64,
        sees_walls: &dyn Fn() -> bool,
    ) -> Option<MountedScan> {
        self.scan_fault = self.checks.scan(scan, sees_walls);
        let odometry = self.odometry.filter(|_| self.scan_fault.is_none())?;
        let mut scan = scan.in_order(self.order);
        scan.range_max_m = scan.range_max_m.min(self.range_m);
        let seen = Seen {
            stamp_ns: scan.stamp_ns,
            arrived_ns,
        };
        if !self.follow("/scan", self.scan, seen, u64::MAX) {
            return None;
        }
        let mounted = match fault_of_times(&scan, arrived_ns, odometry) {
            Some(fault) => Err(fault),
            None => self.mounting.mounted(scan),
        };
        self.scan_fault = mounted.as_ref().err().cloned();
        let mounted = mounted.ok()?;
        self.scan = Some(seen);
        Some(mounted)
    }
}

/// Compares the times of the beams of a scan with those of odometry.
fn fault_of_times(scan: &Scan, arrived_ns: u64, odometry: Seen) -> Option<Fault> {
    let [topic, other] = ["/scan", "/odom"];
    let now_ns = odometry.stamp_ns + arrived_ns.saturating_sub(odometry.arrived_ns);
    let last_ns = beam_time_ns(scan, scan.ranges_m.len().saturating_sub(1));
    let ahead_ns = last_ns.saturating_sub(now_ns);
    let behind_ns = now_ns.saturating_sub(last_ns);
    let of_beams = match (ahead_ns > ODOMETRY_AGE_NS, behind_ns > SCAN_AGE_NS) {
        (true, _) => Some(Fault::ScanAhead(ahead_ns as f64 / SECOND_NS)),
        (_, true) => Some(Fault::ClocksDisagree {
            topic,
            other,
            by_s: -(behind_ns as f64) / SECOND_NS,
        }),
        _ => None,
    };
    of_stamps([topic, other], scan.stamp_ns, odometry.stamp_ns).or(of_beams)
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
