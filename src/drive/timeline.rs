//! Merges late scans and frequent odometry into one timeline, in the steps of the onboard computer.
//!
//! A scan arrives at the end of its turn, so its first beams are one turn old. The onboard computer
//! processes beams at the time they were sent. It therefore lags by up to one turn, and odometry
//! provides the motion since then ([`Timeline::since`]).

use std::collections::VecDeque;
use std::f64::consts::TAU;

use nalgebra::{Isometry2, UnitComplex, Vector2};
use xcscr_sensing::{Return, STEP_NS};

use super::mounting::MountedScan;
use super::readings::{Imu, Odometry, Scan};
use super::wheels::Rolled;
use crate::arena::Speeds;

/// The longest gap between two gyro readings across which the turn rate is known.
const GYRO_GAP_NS: u64 = 75_000_000;
/// The rounding error of a direction, in steps between two beams. Messages have numbers of 32 bits.
const ROUNDED: f64 = 1e-3;
/// The maximum lag of the onboard computer without scans, and the longest gap between two odometry samples.
pub(super) const MOST_LAG_NS: u64 = 2_000_000_000;

/// An odometry sample.
#[derive(Debug, Clone, Copy)]
struct OdometrySample {
    time_ns: u64,
    pose: Isometry2<f64>,
    speeds: Speeds,
    /// The distance travelled along the heading since the start, in metres.
    travel_m: f64,
    /// The angle turned since the start, in radians.
    turned_rad: f64,
}

/// A beam that the onboard computer has not processed yet.
#[derive(Debug, Clone, Copy)]
struct Beam {
    time_ns: u64,
    number: u32,
    bearing: UnitComplex<f64>,
    range_m: Option<f64>,
}

/// The sensor readings of one step.
#[derive(Debug, Default)]
pub struct StepReadings {
    /// The distances rolled by the left and the right wheel, in metres.
    pub rolled_m: [f64; 2],
    /// The angle turned according to the gyro, in radians; `None` without a gyro reading.
    pub turned_rad: Option<f64>,
    /// The beams in chronological order.
    pub beams: Vec<Return>,
}

/// Odometry, gyro and beams that the onboard computer has not processed yet.
#[derive(Debug)]
pub struct Timeline {
    wheel_base_m: f64,
    samples: VecDeque<OdometrySample>,
    /// The integrated gyro: the time, and the angle turned.
    gyro: VecDeque<(u64, f64)>,
    /// The ways of the wheels by their joints; empty if odometry gives them.
    wheels: VecDeque<Rolled>,
    beams: VecDeque<Beam>,
    /// The time up to which the onboard computer has processed all readings.
    time_ns: u64,
    /// No more beams will arrive from before this time.
    horizon_ns: u64,
}

impl Timeline {
    /// Creates an empty timeline for a robot with this distance between its wheels, in metres.
    pub fn new(wheel_base_m: f64) -> Self {
        Self {
            wheel_base_m,
            samples: VecDeque::new(),
            gyro: VecDeque::new(),
            wheels: VecDeque::new(),
            beams: VecDeque::new(),
            time_ns: 0,
            horizon_ns: 0,
        }
    }

    /// Adds odometry, which must be newer than all earlier odometry. What is older than the longest lag is
    /// discarded, so that waiting for the first scan takes no memory.
    pub fn add_odometry(&mut self, odometry: &Odometry) {
        let last = self.samples.back();
        let (travel_m, turned_rad) = last.map_or((0.0, 0.0), |last| {
            let moved = last.pose.inverse() * odometry.pose;
            let turned_rad = moved.rotation.angle();
            let half_rad = turned_rad / 2.0;
            let along = Vector2::new(libm::cos(half_rad), libm::sin(half_rad));
            let chord_m = moved.translation.vector.dot(&along);
            let arc = if half_rad.abs() < 1e-9 {
                1.0
            } else {
                half_rad / libm::sin(half_rad)
            };
            (last.travel_m + arc * chord_m, last.turned_rad + turned_rad)
        });
        self.samples.push_back(OdometrySample {
            time_ns: odometry.stamp_ns,
            pose: odometry.pose,
            speeds: odometry.speeds,
            travel_m,
            turned_rad,
        });
        self.forget(odometry.stamp_ns.saturating_sub(2 * MOST_LAG_NS));
    }

    /// Adds a gyro reading. A reading that is not newer than the last one is dropped.
    pub fn add_imu(&mut self, imu: &Imu) {
        let angle_rad = match self.gyro.back() {
            Some(&(last_ns, _)) if imu.stamp_ns <= last_ns => return,
            Some(&(last_ns, angle_rad)) => {
                angle_rad + imu.turn_radps * (imu.stamp_ns - last_ns) as f64 * 1e-9
            }
            None => 0.0,
        };
        self.gyro.push_back((imu.stamp_ns, angle_rad));
    }

    /// Adds the ways of the wheels at a time after all earlier ones. They replace those from odometry.
    pub fn add_wheels(&mut self, rolled: Rolled) {
        self.wheels.push_back(rolled);
    }

    /// Adds a lidar turn, which must be newer than all earlier turns. The onboard computer counts `beams`
    /// directions in a turn, and gets the beam nearest to each. Returns their number.
    pub fn add_scan(&mut self, mounted: &MountedScan, beams: u32) -> usize {
        let MountedScan {
            scan,
            laser_in_base,
        } = mounted;
        let nearest = resampled(scan, beams);
        for &(index, number) in &nearest {
            let (bearing, range_m) = beam(scan, laser_in_base, index);
            self.beams.push_back(Beam {
                time_ns: beam_time_ns(scan, index),
                number,
                bearing,
                range_m,
            });
        }
        let last_ns = beam_time_ns(scan, scan.ranges_m.len().saturating_sub(1));
        let apart_ns = (scan.time_increment_s * 1e9).round() as u64;
        let rest_ns = if apart_ns == 0 { STEP_NS } else { apart_ns };
        // A margin for rounding, so that the last step of a turn is not delayed.
        self.horizon_ns = last_ns + rest_ns + 1_000;
        nearest.len()
    }

    /// Starts the onboard computer at a time.
    pub fn begin(&mut self, time_ns: u64) {
        self.time_ns = time_ns;
    }

    /// Returns the time up to which the onboard computer has processed all readings.
    pub fn time_ns(&self) -> u64 {
        self.time_ns
    }

    /// Returns the newest odometry: time, pose and speeds.
    pub fn latest(&self) -> Option<(u64, Isometry2<f64>, Speeds)> {
        let latest = self.samples.back()?;
        Some((latest.time_ns, latest.pose, latest.speeds))
    }

    /// Returns the motion since the time of the onboard computer, by odometry.
    pub fn since(&self) -> Option<Isometry2<f64>> {
        Some(self.pose_at(self.time_ns)?.inverse() * self.samples.back()?.pose)
    }

    /// Returns the odometry pose at a time. Outside of the known times, returns the oldest or
    /// newest known pose.
    pub fn pose_at(&self, time_ns: u64) -> Option<Isometry2<f64>> {
        let (before, after, share) = self.around(time_ns)?;
        let moved = before.pose.inverse() * after.pose;
        let turn = UnitComplex::new(share * moved.rotation.angle());
        let part = Isometry2::from_parts((share * moved.translation.vector).into(), turn);
        Some(before.pose * part)
    }

    /// Returns the samples before and after a time, and the position of the time between them, from
    /// 0 to 1.
    fn around(&self, time_ns: u64) -> Option<(&OdometrySample, &OdometrySample, f64)> {
        let after = self.samples.partition_point(|s| s.time_ns < time_ns);
        let last = self.samples.len().checked_sub(1)?;
        let (after, before) = (after.min(last), after.saturating_sub(1));
        let (before, after) = (self.samples.get(before)?, self.samples.get(after)?);
        let whole_ns = after.time_ns.saturating_sub(before.time_ns);
        let share = match whole_ns {
            0 => 0.0,
            _ => time_ns.saturating_sub(before.time_ns) as f64 / whole_ns as f64,
        };
        Some((before, after, share.min(1.0)))
    }

    /// Returns the readings of the next step of the onboard computer, once odometry and scans reach
    /// its end.
    pub fn next_step(&mut self) -> Option<StepReadings> {
        let of_wheels = self.wheels.back().map_or(u64::MAX, |rolled| rolled.0);
        let latest_ns = self.samples.back()?.time_ns.min(of_wheels);
        let end_ns = self.time_ns + STEP_NS;
        let is_late = end_ns + MOST_LAG_NS <= latest_ns;
        if end_ns > latest_ns || (end_ns > self.horizon_ns && !is_late) {
            return None;
        }
        let readings = StepReadings {
            rolled_m: self.rolled(self.time_ns, end_ns)?,
            turned_rad: self.turned(self.time_ns, end_ns),
            beams: self.beams_until(end_ns),
        };
        self.time_ns = end_ns;
        self.forget(end_ns);
        Some(readings)
    }

    fn rolled(&self, from_ns: u64, to_ns: u64) -> Option<[f64; 2]> {
        if let (Some(from), Some(to)) = (self.wheels_at(from_ns), self.wheels_at(to_ns)) {
            return Some([to[0] - from[0], to[1] - from[1]]);
        }
        let at = |time_ns| {
            let (before, after, share) = self.around(time_ns)?;
            let between = |a: f64, b: f64| a + share * (b - a);
            Some([
                between(before.travel_m, after.travel_m),
                between(before.turned_rad, after.turned_rad),
            ])
        };
        let ([from_m, from_rad], [to_m, to_rad]) = (at(from_ns)?, at(to_ns)?);
        let half_m = (to_rad - from_rad) * self.wheel_base_m / 2.0;
        Some([to_m - from_m - half_m, to_m - from_m + half_m])
    }

    /// Returns the ways of the wheels at a time. Outside of the known times, returns the oldest or newest
    /// known ways.
    fn wheels_at(&self, time_ns: u64) -> Option<[f64; 2]> {
        let next = self.wheels.partition_point(|rolled| rolled.0 < time_ns);
        let after = self.wheels.get(next).or(self.wheels.back())?;
        let before = next.checked_sub(1).and_then(|at| self.wheels.get(at));
        let before = before.unwrap_or(after);
        let whole_ns = after.0.saturating_sub(before.0).max(1);
        let share = time_ns.saturating_sub(before.0) as f64 / whole_ns as f64;
        let share = share.min(1.0);
        Some([0, 1].map(|wheel| before.1[wheel] + share * (after.1[wheel] - before.1[wheel])))
    }

    /// Returns the angle turned according to the gyro; `None` if the gyro does not cover the
    /// interval, or a reading is missing.
    fn turned(&self, from_ns: u64, to_ns: u64) -> Option<f64> {
        let first = self
            .gyro
            .partition_point(|&(gyro_ns, _)| gyro_ns <= from_ns);
        let last = self.gyro.partition_point(|&(gyro_ns, _)| gyro_ns < to_ns);
        let covering = self
            .gyro
            .range(first.saturating_sub(1)..(last + 1).min(self.gyro.len()));
        let ends = covering.clone().skip(1);
        let has_gap = covering.zip(ends).any(|(a, b)| b.0 - a.0 > GYRO_GAP_NS);
        if has_gap {
            return None;
        }
        let at = |time_ns| {
            let next = self.gyro.partition_point(|&(gyro_ns, _)| gyro_ns < time_ns);
            let &(after_ns, after_rad) = self.gyro.get(next)?;
            let before = next.checked_sub(1).and_then(|before| self.gyro.get(before));
            match before {
                Some(&(before_ns, before_rad)) => {
                    let share = (time_ns - before_ns) as f64 / (after_ns - before_ns) as f64;
                    Some(before_rad + share * (after_rad - before_rad))
                }
                None => (after_ns == time_ns).then_some(after_rad),
            }
        };
        Some(at(to_ns)? - at(from_ns)?)
    }

    fn beams_until(&mut self, end_ns: u64) -> Vec<Return> {
        let mut returns = Vec::new();
        while let Some(beam) = self.beams.front().copied() {
            if beam.time_ns >= end_ns {
                break;
            }
            self.beams.pop_front();
            if beam.time_ns < self.time_ns {
                continue;
            }
            returns.push(Return {
                number: beam.number,
                moment: (beam.time_ns - self.time_ns) as f64 / STEP_NS as f64,
                bearing: beam.bearing,
                range_m: beam.range_m,
            });
        }
        returns
    }

    /// Discards odometry and gyro readings that are not needed from a time on.
    fn forget(&mut self, from_ns: u64) {
        while self.samples.get(1).is_some_and(|s| s.time_ns <= from_ns) {
            self.samples.pop_front();
        }
        while self.wheels.get(1).is_some_and(|w| w.0 <= from_ns) {
            self.wheels.pop_front();
        }
        while self.gyro.get(1).is_some_and(|g| g.0 <= from_ns) {
            self.gyro.pop_front();
        }
    }
}

/// Returns the beams of a scan that are the nearest ones to the directions of a turn, in the order of
/// the scan: the index in the scan and the number of the direction.
fn resampled(scan: &Scan, beams: u32) -> Vec<(usize, u32)> {
    let step_rad = TAU / f64::from(beams);
    let mut nearest: Vec<Option<(f64, usize)>> = vec![None; beams as usize];
    for index in 0..scan.ranges_m.len() {
        let angle_rad = scan.angle_min_rad + index as f64 * scan.angle_increment_rad;
        let place = angle_rad / step_rad;
        let off = (place - place.round()).abs();
        // The checked angles are a few turns at most.
        let number = place.round().rem_euclid(f64::from(beams)) as usize;
        if nearest[number].is_none_or(|(least, _)| off < least - ROUNDED) {
            nearest[number] = Some((off, index));
        }
    }
    let numbered = nearest.iter().zip(0..);
    let mut all: Vec<_> = numbered
        .filter_map(|(nearest, number)| Some((nearest.as_ref()?.1, number)))
        .collect();
    all.sort_unstable();
    all
}

/// Returns the direction of a beam relative to the robot's heading, and its range from the robot's
/// centre.
fn beam(
    scan: &Scan,
    laser_in_base: &Isometry2<f64>,
    index: usize,
) -> (UnitComplex<f64>, Option<f64>) {
    let angle_rad = scan.angle_min_rad + index as f64 * scan.angle_increment_rad;
    let (sine, cosine) = libm::sincos(angle_rad);
    let direction = laser_in_base.rotation * Vector2::new(cosine, sine);
    let bearing = |v: Vector2<f64>| UnitComplex::new_normalize(nalgebra::Complex::new(v.x, v.y));
    let Some(range_m) = scan.measured_m(index) else {
        return (bearing(direction), None);
    };
    if scan.ranges_m[index] < scan.range_min_m {
        return (bearing(direction), Some(f64::NEG_INFINITY));
    }
    let end = laser_in_base.translation.vector + range_m * direction;
    let far_m = end.norm();
    if far_m > 0.0 {
        (bearing(end), Some(far_m))
    } else {
        (bearing(direction), None)
    }
}

/// Returns the time of a beam of a scan, in nanoseconds.
pub fn beam_time_ns(scan: &Scan, number: usize) -> u64 {
    let after_ns = (number as f64 * scan.time_increment_s.max(0.0) * 1e9).round() as u64;
    scan.stamp_ns.saturating_add(after_ns)
}
