//! The robot's trajectory, simplified to few poses.

use nalgebra::Vector2;

use crate::event::Pose;

/// The minimum time between the poses that are considered.
const PERIOD_NS: u64 = 50_000_000;
/// The maximum time between two written poses.
const MAX_INTERVAL_NS: u64 = 500_000_000;
/// Viewers interpolate linearly between two poses. Poses in between are omitted if the
/// interpolation error is at most this share of a cell.
const MAX_OFFSET: f64 = 0.012;
/// The maximum interpolation error of the heading, in radians.
const MAX_TURN_ERROR_RAD: f64 = 0.045;

/// The written poses of the last move; at first the start of the episode.
#[derive(Debug)]
pub(super) struct Trajectory {
    poses: Vec<Pose>,
    off_m: f64,
}

impl Trajectory {
    /// Creates an empty trajectory through cells of this size in metres.
    pub fn new(unit_m: f64) -> Self {
        Self {
            poses: Vec::new(),
            off_m: MAX_OFFSET * unit_m,
        }
    }

    /// Starts a new trajectory at the episode's start.
    pub fn restart(&mut self, now: Pose) {
        self.poses.clear();
        self.poses.push(now);
    }

    /// Replaces the trajectory by that of a move, which begins where the last one ended.
    pub fn follow(&mut self, trace: &[Pose]) {
        self.poses.drain(..self.poses.len().saturating_sub(1));
        let mut considered: Vec<Pose> = self.poses.clone();
        let end_ns = trace.last().map(|sample| sample.time_ns);
        for sample in trace {
            let ahead_ns = match considered.last() {
                Some(before) => sample.time_ns.saturating_sub(before.time_ns),
                None => PERIOD_NS,
            };
            if ahead_ns >= PERIOD_NS || ahead_ns > 0 && Some(sample.time_ns) == end_ns {
                considered.push(*sample);
            }
        }
        self.poses = simplified(&considered, self.off_m);
    }

    /// Returns the poses, oldest first.
    pub fn poses(&self) -> &[Pose] {
        &self.poses
    }
}

/// Returns the poses without those that viewers interpolate closely enough.
fn simplified(poses: &[Pose], off_m: f64) -> Vec<Pose> {
    let turned_rad = turned(poses);
    let mut simplified = Vec::new();
    let mut from = 0;
    while from < poses.len() {
        simplified.push(poses[from]);
        let mut to = from + 1;
        while to + 1 < poses.len() && spans(poses, &turned_rad, from, to + 1, off_m) {
            to += 1;
        }
        from = to;
    }
    simplified
}

/// Returns the accumulated rotation up to each pose, in radians.
fn turned(poses: &[Pose]) -> Vec<f64> {
    let mut sum_rad = 0.0;
    let mut turned_rad = vec![0.0; poses.len().min(1)];
    for pair in poses.windows(2) {
        let [before, after] = [0, 1].map(|at| pair[at].robot_in_map.rotation);
        let turn = before.inverse() * after;
        sum_rad += libm::atan2(turn.im, turn.re);
        turned_rad.push(sum_rad);
    }
    turned_rad
}

/// Returns true if all poses between two of them may be omitted.
fn spans(poses: &[Pose], turned_rad: &[f64], from: usize, to: usize, off_m: f64) -> bool {
    let length_ns = poses[to].time_ns - poses[from].time_ns;
    let place = |at: usize| -> Vector2<f64> { poses[at].robot_in_map.translation.vector };
    length_ns <= MAX_INTERVAL_NS
        && (from + 1..to).all(|at| {
            let share = (poses[at].time_ns - poses[from].time_ns) as f64 / length_ns as f64;
            let drawn = place(from) + (place(to) - place(from)) * share;
            let drawn_rad = turned_rad[from] + (turned_rad[to] - turned_rad[from]) * share;
            (place(at) - drawn).norm() <= off_m
                && (turned_rad[at] - drawn_rad).abs() <= MAX_TURN_ERROR_RAD
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Isometry2, Vector2};

    /// Returns poses every 10 ms, whose position and heading follow from the time in seconds.
    fn trace(seconds: f64, pose: impl Fn(f64) -> (f64, f64)) -> Vec<Pose> {
        let count = (seconds * 100.0) as u64;
        let sample = |number: u64| {
            let (x, heading_rad) = pose(number as f64 / 100.0);
            Pose {
                time_ns: number * 10_000_000,
                robot_in_map: Isometry2::new(Vector2::new(x, 0.0), heading_rad),
                robot_in_odom: Isometry2::identity(),
                estimate: None,
                velocity_mps: Vector2::zeros(),
                turn_radps: 0.0,
            }
        };
        (0..=count).map(sample).collect()
    }

    fn trajectory(trace: &[Pose]) -> Trajectory {
        let mut trajectory = Trajectory::new(1.0);
        trajectory.restart(trace[0]);
        trajectory.follow(trace);
        trajectory
    }

    #[test]
    fn uniform_motion_takes_two_poses_a_second() {
        let even = trace(4.0, |s| (0.3 * s, 0.5 * s));
        let times: Vec<u64> = trajectory(&even)
            .poses()
            .iter()
            .map(|p| p.time_ns)
            .collect();
        let every: Vec<u64> = (0..=8).map(|at| at * 500_000_000).collect();
        assert_eq!(times, every);
    }

    #[test]
    fn interpolated_poses_are_close_to_the_true_poses() {
        let swerving = trace(3.0, |s| (s * s / 4.0, (2.0 * s).sin()));
        let trajectory = trajectory(&swerving);
        let poses = trajectory.poses();
        assert!((8..40).contains(&poses.len()), "{} poses", poses.len());
        for sample in swerving.iter().filter(|s| s.time_ns % PERIOD_NS == 0) {
            let after = poses.partition_point(|pose| pose.time_ns < sample.time_ns);
            let [a, b] = [after.saturating_sub(1), after].map(|at| poses[at]);
            let share = (sample.time_ns - a.time_ns) as f64 / (b.time_ns - a.time_ns).max(1) as f64;
            let drawn = a.robot_in_map.lerp_slerp(&b.robot_in_map, share);
            let apart = drawn.inverse() * sample.robot_in_map;
            assert!(apart.translation.vector.norm() <= 0.02, "{sample:?}");
            assert!(
                apart.rotation.angle().abs() <= 2.0 * MAX_TURN_ERROR_RAD,
                "{sample:?}"
            );
        }
    }
}
