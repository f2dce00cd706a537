//! Detects obstacles in the robot's path from scans, like a contactless bumper. What is behind the
//! end of the path is no obstacle.

use nalgebra::{Isometry2, Point2, Vector2};

use super::mounting::MountedScan;
use super::timeline::{Timeline, beam_time_ns};

/// The number of beams that must end in the path, because a single beam may be wrong.
const ENOUGH: usize = 2;
/// The width of the path as a share of the robot's width. It is below 1 because ranges are noisy.
const NARROWER: f64 = 0.9;
/// The delay until a command takes effect, in seconds.
const DELAY_S: f64 = 0.1;

/// The end points of the beams of the last scan, in the odometry frame.
#[derive(Debug, Clone, Default)]
pub struct Obstacles {
    points: Vec<Point2<f64>>,
}

/// The robot's braking parameters.
#[derive(Debug, Clone, Copy)]
pub struct Braking {
    /// The radius of the robot in metres.
    pub radius_m: f64,
    /// The deceleration in m/s^2.
    pub deceleration_mps2: f64,
    /// The remaining distance to keep, in metres.
    pub margin_m: f64,
}

impl Obstacles {
    /// Stores the end points of a scan's beams.
    pub fn see(&mut self, mounted: &MountedScan, timeline: &Timeline) {
        let MountedScan {
            scan,
            laser_in_base,
        } = mounted;
        self.points.clear();
        for number in 0..scan.ranges_m.len() {
            let base = timeline.pose_at(beam_time_ns(scan, number));
            let (Some(range_m), Some(base)) = (scan.measured_m(number), base) else {
                continue;
            };
            let angle_rad = scan.angle_min_rad + number as f64 * scan.angle_increment_rad;
            let (sine, cosine) = libm::sincos(angle_rad);
            let end = Point2::new(range_m * cosine, range_m * sine);
            self.points.push(base * laser_in_base * end);
        }
    }

    /// Returns true if an obstacle is so near that the robot must brake now. The robot is at `pose`
    /// in the odometry frame, and drives at `speed_mps` along the unit vector `along` of its own
    /// frame, for `left_m` more metres.
    pub fn is_in_the_path(
        &self,
        pose: &Isometry2<f64>,
        (along, left_m): (Vector2<f64>, f64),
        speed_mps: f64,
        braking: Braking,
    ) -> bool {
        let Braking {
            radius_m,
            deceleration_mps2,
            margin_m,
        } = braking;
        let needed_m = speed_mps * speed_mps / (2.0 * deceleration_mps2)
            + DELAY_S * speed_mps.abs()
            + margin_m;
        // A move ends within the margin of its target.
        let needed_m = needed_m.min(left_m - margin_m);
        let is_near = |point: &&Point2<f64>| {
            let at = pose.inverse_transform_point(point).coords;
            let (ahead_m, beside_m) = (at.dot(&along), at.perp(&along).abs());
            let bulge_m = (radius_m * radius_m - beside_m * beside_m).max(0.0).sqrt();
            ahead_m > 0.0 && beside_m < NARROWER * radius_m && ahead_m - bulge_m < needed_m
        };
        self.points.iter().filter(is_near).take(ENOUGH).count() == ENOUGH
    }
}
