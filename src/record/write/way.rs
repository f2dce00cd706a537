//! The way of the robot, in as few poses as show it.

use nalgebra::Vector2;

use crate::arena::Sample;

/// Of the physics steps, those at least so far apart are looked at.
const PERIOD_NS: u64 = 50_000_000;
/// Two poses that are written are at most so far apart.
const LONGEST_NS: u64 = 500_000_000;
/// A message shows where the robot is and so much of what comes next.
const AHEAD_NS: u64 = 2_000_000_000;
/// Between two poses a viewer draws the robot on a straight line, turning evenly. Poses in between
/// are left out when that is so far from the truth at most: a share of a cell ...
const OFF: f64 = 0.012;
/// ... and an angle in radians.
const TURNED_RAD: f64 = 0.045;

/// The poses of the last move that are written; at first where the episode began.
#[derive(Debug)]
pub(super) struct Way {
    poses: Vec<Sample>,
    off_m: f64,
}

impl Way {
    /// No way yet, through cells of this size.
    pub fn new(unit_m: f64) -> Self {
        Self {
            poses: Vec::new(),
            off_m: OFF * unit_m,
        }
    }

    /// An episode begins here.
    pub fn restart(&mut self, now: Sample) {
        self.poses.clear();
        self.poses.push(now);
    }

    /// Takes the way of a move, which begins where the last one ended.
    pub fn follow(&mut self, trace: &[Sample]) {
        self.poses.drain(..self.poses.len().saturating_sub(1));
        let mut looked_at: Vec<Sample> = self.poses.clone();
        let end_ns = trace.last().map(|sample| sample.time_ns);
        for sample in trace {
            let ahead_ns = match looked_at.last() {
                Some(before) => sample.time_ns.saturating_sub(before.time_ns),
                None => PERIOD_NS,
            };
            if ahead_ns >= PERIOD_NS || ahead_ns > 0 && Some(sample.time_ns) == end_ns {
                looked_at.push(*sample);
            }
        }
        self.poses = thinned(&looked_at, self.off_m);
    }

    /// The poses, oldest first.
    pub fn poses(&self) -> &[Sample] {
        &self.poses
    }

    /// The poses message by message; each begins with the last pose of the one before.
    pub fn stretches(&self) -> Vec<&[Sample]> {
        let mut stretches = Vec::new();
        let mut from = 0;
        while from + 1 < self.poses.len() {
            let until_ns = self.poses[from].time_ns + AHEAD_NS;
            let within = self.poses[from + 1..].iter();
            let within = within.take_while(|pose| pose.time_ns <= until_ns).count();
            let to = from + within.max(1);
            stretches.push(&self.poses[from..=to]);
            from = to;
        }
        stretches
    }
}

/// The poses without those that a viewer draws where they are, too.
fn thinned(poses: &[Sample], off_m: f64) -> Vec<Sample> {
    let turned_rad = turned(poses);
    let mut kept = Vec::new();
    let mut from = 0;
    while from < poses.len() {
        kept.push(poses[from]);
        let mut to = from + 1;
        while to + 1 < poses.len() && spans(poses, &turned_rad, from, to + 1, off_m) {
            to += 1;
        }
        from = to;
    }
    kept
}

/// How far the robot has turned up to each pose, in radians.
fn turned(poses: &[Sample]) -> Vec<f64> {
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

/// May all poses between two of them be left out?
fn spans(poses: &[Sample], turned_rad: &[f64], from: usize, to: usize, off_m: f64) -> bool {
    let length_ns = poses[to].time_ns - poses[from].time_ns;
    let place = |at: usize| -> Vector2<f64> { poses[at].robot_in_map.translation.vector };
    length_ns <= LONGEST_NS
        && (from + 1..to).all(|at| {
            let share = (poses[at].time_ns - poses[from].time_ns) as f64 / length_ns as f64;
            let drawn = place(from) + (place(to) - place(from)) * share;
            let drawn_rad = turned_rad[from] + (turned_rad[to] - turned_rad[from]) * share;
            (place(at) - drawn).norm() <= off_m && (turned_rad[at] - drawn_rad).abs() <= TURNED_RAD
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Isometry2, Vector2};

    /// Poses every 10 ms, whose place and heading follow from the time in seconds.
    fn trace(seconds: f64, pose: impl Fn(f64) -> (f64, f64)) -> Vec<Sample> {
        let count = (seconds * 100.0) as u64;
        let sample = |number: u64| {
            let (x, heading_rad) = pose(number as f64 / 100.0);
            Sample {
                time_ns: number * 10_000_000,
                robot_in_map: Isometry2::new(Vector2::new(x, 0.0), heading_rad),
                wheel_travel_m: [0.0; 2],
            }
        };
        (0..=count).map(sample).collect()
    }

    fn way(trace: &[Sample]) -> Way {
        let mut way = Way::new(1.0);
        way.restart(trace[0]);
        way.follow(trace);
        way
    }

    #[test]
    fn a_robot_that_drives_and_turns_evenly_takes_two_poses_a_second() {
        let even = trace(4.0, |s| (0.3 * s, 0.5 * s));
        let times: Vec<u64> = way(&even).poses().iter().map(|p| p.time_ns).collect();
        let every: Vec<u64> = (0..=8).map(|at| at * 500_000_000).collect();
        assert_eq!(times, every);
    }

    #[test]
    fn what_a_viewer_draws_is_where_the_robot_was() {
        let swerving = trace(3.0, |s| (s * s / 4.0, (2.0 * s).sin()));
        let way = way(&swerving);
        let poses = way.poses();
        assert!((8..40).contains(&poses.len()), "{} poses", poses.len());
        for sample in swerving.iter().filter(|s| s.time_ns % PERIOD_NS == 0) {
            let after = poses.partition_point(|pose| pose.time_ns < sample.time_ns);
            let [a, b] = [after.saturating_sub(1), after].map(|at| poses[at]);
            let share = (sample.time_ns - a.time_ns) as f64 / (b.time_ns - a.time_ns).max(1) as f64;
            let drawn = a.robot_in_map.lerp_slerp(&b.robot_in_map, share);
            let apart = drawn.inverse() * sample.robot_in_map;
            assert!(apart.translation.vector.norm() <= 0.02, "{sample:?}");
            assert!(
                apart.rotation.angle().abs() <= 2.0 * TURNED_RAD,
                "{sample:?}"
            );
        }
    }

    #[test]
    fn messages_follow_each_other_without_a_gap() {
        let way = way(&trace(4.0, |s| (0.3 * s, (3.0 * s).sin())));
        let stretches = way.stretches();
        assert_eq!(stretches[0][0], way.poses()[0]);
        assert_eq!(stretches.last().unwrap().last(), way.poses().last());
        for pair in stretches.windows(2) {
            assert_eq!(pair[0].last(), pair[1].first());
            assert!(pair[0].last().unwrap().time_ns - pair[0][0].time_ns <= AHEAD_NS);
        }
    }
}
