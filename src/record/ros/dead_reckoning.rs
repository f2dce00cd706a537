//! Dead reckoning: the pose of a robot that only counts wheel rotation.

use nalgebra::Isometry2;

use crate::arena::Sample;
use crate::drive::rolled;

/// The pose in the frame `odom`: it never jumps, but drifts away from the true pose (REP 105).
pub struct DeadReckoning {
    /// The distance between the wheels in metres; `None` for a robot without wheels.
    wheel_base_m: Option<f64>,
    pose: Isometry2<f64>,
    last: Option<Sample>,
}

/// A step of dead reckoning.
pub struct Motion {
    /// The robot's pose in the frame in which dead reckoning began.
    pub pose: Isometry2<f64>,
    /// The odometry motion since the last sample, in the robot's own frame.
    pub moved: Isometry2<f64>,
    /// The true motion since the last sample, in the robot's own frame.
    pub truly_moved: Isometry2<f64>,
    /// The time since the last sample, in seconds.
    pub since_s: f64,
}

impl DeadReckoning {
    /// Starts at the origin of its own frame.
    pub fn new(wheel_base_m: Option<f64>) -> Self {
        Self {
            wheel_base_m,
            pose: Isometry2::identity(),
            last: None,
        }
    }

    /// Forgets the last sample when the robot is placed somewhere else, which is not motion.
    pub fn put_down(&mut self) {
        self.last = None;
    }

    /// Advances to the next sample.
    pub fn step(&mut self, now: &Sample) -> Motion {
        let last = self.last.replace(*now).unwrap_or(*now);
        let truly_moved = last.robot_in_map.inverse() * now.robot_in_map;
        let moved = match self.wheel_base_m {
            Some(base_m) => rolled(last.wheel_travel_m, now.wheel_travel_m, base_m),
            None => truly_moved,
        };
        self.pose *= moved;
        self.pose.rotation.renormalize();
        Motion {
            pose: self.pose,
            moved,
            truly_moved,
            since_s: now.time_ns.saturating_sub(last.time_ns) as f64 * 1e-9,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn sample(time_ns: u64, wheel_travel_m: [f64; 2]) -> Sample {
        Sample {
            time_ns,
            robot_in_map: Isometry2::identity(),
            wheel_travel_m,
        }
    }

    #[test]
    fn equal_wheel_travel_gives_a_straight_line_and_other_travel_an_arc() {
        let mut reckoning = DeadReckoning::new(Some(0.5));
        reckoning.step(&sample(0, [0.0, 0.0]));
        let motion = reckoning.step(&sample(500_000_000, [1.0, 1.0]));
        assert_eq!(motion.pose.translation.vector.as_slice(), [1.0, 0.0]);
        assert_eq!(motion.since_s, 0.5);
        // A quarter circle of radius 1 to the left, then the robot is placed where it started.
        let travel = [1.0 + 0.75 * FRAC_PI_2, 1.0 + 1.25 * FRAC_PI_2];
        let pose = reckoning.step(&sample(1, travel)).pose;
        let missing = pose.translation.vector - nalgebra::Vector2::new(2.0, 1.0);
        assert!(missing.norm() < 1e-12, "{pose}");
        assert!((pose.rotation.angle() - PI / 2.0).abs() < 1e-12, "{pose}");
        reckoning.put_down();
        let after = reckoning.step(&sample(2, [0.0, 0.0]));
        assert_eq!((after.pose, after.since_s), (pose, 0.0));
    }
}
