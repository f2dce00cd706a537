//! Dead reckoning, and the poses of a move.

use nalgebra::{Complex, Isometry2, Translation2, UnitComplex};

use crate::event::Pose;
use xcscr_robot::arena::{Sample, View};

/// Computes poses, with those of a robot that only counts the rotation of its wheels.
#[derive(Debug)]
pub(super) struct Odometry {
    /// The distance between the wheels in metres; `None` for a robot without wheels.
    wheel_base_m: Option<f64>,
    robot_in_odom: Isometry2<f64>,
    last: Option<Sample>,
}

impl Odometry {
    /// Starts at the origin of the frame `odom`.
    pub fn new(wheel_base_m: Option<f64>) -> Self {
        Self {
            wheel_base_m,
            robot_in_odom: Isometry2::identity(),
            last: None,
        }
    }

    /// Starts again where the robot is now. Being placed somewhere is not motion.
    pub fn restart(&mut self) {
        *self = Self::new(self.wheel_base_m);
    }

    /// Returns the poses of a move, one for each sample of its trace.
    pub fn follow(&mut self, view: &View<'_>) -> Vec<Pose> {
        let estimates = view.sensed.map_or(&[][..], |sensed| sensed.estimates);
        let samples = view.trace.iter().enumerate();
        samples
            .map(|(at, sample)| Pose {
                estimate: estimates.get(at).copied(),
                ..self.step(sample)
            })
            .collect()
    }

    fn step(&mut self, now: &Sample) -> Pose {
        let last = self.last.replace(*now).unwrap_or(*now);
        let moved = last.robot_in_map.inv_mul(&now.robot_in_map);
        self.robot_in_odom *= match self.wheel_base_m {
            Some(base_m) => rolled(last.wheel_travel_m, now.wheel_travel_m, base_m),
            None => moved,
        };
        self.robot_in_odom.rotation.renormalize();
        let seconds = now.time_ns.saturating_sub(last.time_ns) as f64 / 1e9;
        let rate_hz = if seconds > 0.0 { 1.0 / seconds } else { 0.0 };
        Pose {
            time_ns: now.time_ns,
            robot_in_map: now.robot_in_map,
            robot_in_odom: self.robot_in_odom,
            estimate: None,
            velocity_mps: moved.translation.vector * rate_hz,
            turn_radps: libm::atan2(moved.rotation.im, moved.rotation.re) * rate_hz,
        }
    }
}

/// Returns the arc of a robot whose left and right wheel rolled from `from` to `to`, in metres.
pub fn rolled(from: [f64; 2], to: [f64; 2], base_m: f64) -> Isometry2<f64> {
    let [left, right] = [to[0] - from[0], to[1] - from[1]];
    let (distance, half_rad) = ((left + right) / 2.0, (right - left) / base_m / 2.0);
    let (sine, cosine) = libm::sincos(half_rad);
    let chord = if half_rad == 0.0 {
        distance
    } else {
        distance * sine / half_rad
    };
    let half = UnitComplex::new_unchecked(Complex::new(cosine, sine));
    Isometry2::from_parts(Translation2::new(chord * cosine, chord * sine), half * half)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn sample(time_ns: u64, x_m: f64, wheel_travel_m: [f64; 2]) -> Sample {
        Sample {
            time_ns,
            robot_in_map: Isometry2::translation(x_m, 0.0),
            wheel_travel_m,
        }
    }

    #[test]
    fn equal_wheel_travel_gives_a_straight_line_and_other_travel_an_arc() {
        let mut odometry = Odometry::new(Some(0.5));
        odometry.step(&sample(0, 3.0, [0.0, 0.0]));
        let pose = odometry.step(&sample(500_000_000, 4.0, [1.0, 1.0]));
        let moved = pose.robot_in_odom.translation.vector;
        assert_eq!(moved.as_slice(), [1.0, 0.0]);
        assert_eq!(pose.velocity_mps.as_slice(), [2.0, 0.0]);
        // A quarter circle of radius 1 to the left.
        let travel = [1.0 + 0.75 * FRAC_PI_2, 1.0 + 1.25 * FRAC_PI_2];
        let pose = odometry
            .step(&sample(1_000_000_000, 4.0, travel))
            .robot_in_odom;
        let missing = pose.translation.vector - nalgebra::Vector2::new(2.0, 1.0);
        assert!(missing.norm() < 1e-12, "{pose}");
        assert!((pose.rotation.angle() - FRAC_PI_2).abs() < 1e-12, "{pose}");
    }

    #[test]
    fn a_robot_that_is_placed_somewhere_has_not_moved() {
        let mut odometry = Odometry::new(None);
        odometry.step(&sample(0, 3.0, [0.0, 0.0]));
        odometry.restart();
        let pose = odometry.step(&sample(1_000_000_000, 7.0, [0.0, 0.0]));
        assert_eq!(pose.robot_in_odom, Isometry2::identity());
        assert_eq!(pose.velocity_mps.norm(), 0.0);
    }
}
