//! Looks for something in the robot's way: a bumper that does not touch.

use nalgebra::{Isometry2, Point2, Vector2};

use super::readings::Scan;
use super::timeline::{Timeline, beam_time_ns};

/// One beam may be wrong: so many must end in the way.
const ENOUGH: usize = 2;
/// The way is narrower than the robot by this share, because ranges have noise.
const NARROWER: f64 = 0.9;
/// How long a command takes to have an effect, in seconds.
const DELAY_S: f64 = 0.1;

/// Where the beams of the last scan ended, in the frame of odometry.
#[derive(Debug, Clone, Default)]
pub struct Obstacles {
    points: Vec<Point2<f64>>,
}

/// What the robot needs to stop.
#[derive(Debug, Clone, Copy)]
pub struct Braking {
    /// The radius of the robot in metres.
    pub radius_m: f64,
    /// Its deceleration in m/s^2.
    pub deceleration_mps2: f64,
    /// The distance that must be left in metres.
    pub margin_m: f64,
}

impl Obstacles {
    /// Keeps where the beams of a scan end.
    pub fn see(&mut self, scan: &Scan, timeline: &Timeline, laser_in_base: &Isometry2<f64>) {
        self.points.clear();
        for (number, &range_m) in scan.ranges_m.iter().enumerate() {
            let range_m = match range_m {
                near_m if near_m < scan.range_min_m => scan.range_min_m,
                range_m if range_m <= scan.range_max_m => range_m,
                _ => continue,
            };
            let Some(base) = timeline.pose_at(beam_time_ns(scan, number)) else {
                continue;
            };
            let angle_rad = scan.angle_min_rad + number as f64 * scan.angle_increment_rad;
            let (sine, cosine) = libm::sincos(angle_rad);
            let end = Point2::new(range_m * cosine, range_m * sine);
            self.points.push(base * laser_in_base * end);
        }
    }

    /// Is something so near that the robot must brake now? The robot is at `pose` in the frame of odometry, and drives with
    /// `speed_mps` along the unit vector `along` of its own frame.
    pub fn is_in_the_way(
        &self,
        pose: &Isometry2<f64>,
        along: Vector2<f64>,
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
        let is_near = |point: &&Point2<f64>| {
            let at = pose.inverse_transform_point(point).coords;
            let (ahead_m, beside_m) = (at.dot(&along), at.perp(&along).abs());
            let bulge_m = (radius_m * radius_m - beside_m * beside_m).max(0.0).sqrt();
            ahead_m > 0.0 && beside_m < NARROWER * radius_m && ahead_m - bulge_m < needed_m
        };
        self.points.iter().filter(is_near).take(ENOUGH).count() == ENOUGH
    }
}
