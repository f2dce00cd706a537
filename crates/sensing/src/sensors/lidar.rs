//! The lidar: beams that go round, a few in every step.

use nalgebra::{Complex, UnitComplex, Vector2};

use super::{Moment, Terrain, ahead, ray};
use crate::{LidarParams, Return};
use xcs::random::Stream;

/// A lidar that turns at a constant rate. Each beam draws the same count of random numbers.
#[derive(Debug, Clone)]
pub(super) struct Lidar {
    params: LidarParams,
    /// The directions of a whole turn.
    bearings: Vec<UnitComplex<f64>>,
    per_step: f64,
    scale: f64,
    offset: f64,
    level: f64,
    pub(super) stream: Stream,
}

impl Lidar {
    /// The lidar of the robot that draws from `stream`, at a noise level.
    pub(super) fn new(params: &LidarParams, level: f64, mut stream: Stream) -> Self {
        Self {
            bearings: params.bearings(),
            per_step: params.beams_per_step(),
            scale: 1.0 + level * params.scale * stream.normal(),
            offset: level * params.offset_m * stream.normal(),
            level,
            params: params.clone(),
            stream,
        }
    }

    /// The beams of a step during which the robot turns by `turned_rad`, in the order of time.
    pub(super) fn scan(
        &mut self,
        terrain: &dyn Terrain,
        moment: &Moment<'_>,
        turned_rad: f64,
        beams: &mut Vec<Return>,
    ) {
        beams.clear();
        if !self.params.fitted {
            return;
        }
        let start = moment.step as f64 * self.per_step;
        let numbers = start.ceil() as u64..(start + self.per_step).ceil() as u64;
        let way = moment.after.translation.vector - moment.before.translation.vector;
        for number in numbers {
            let share = (number as f64 - start) / self.per_step;
            let origin = moment.before.translation.vector + share * way;
            let heading = moment.before.rotation * rotation(share * turned_rad);
            let bearing = self.bearings[(number % self.bearings.len() as u64) as usize];
            beams.push(Return {
                moment: share,
                bearing,
                range_m: self.measure(terrain, origin, heading * bearing),
            });
        }
    }

    /// One beam from `origin`.
    fn measure(
        &mut self,
        terrain: &dyn Terrain,
        origin: Vector2<f64>,
        direction: UnitComplex<f64>,
    ) -> Option<f64> {
        let LidarParams {
            range_m, nearest_m, ..
        } = self.params;
        let (jitter, noise) = (self.stream.normal(), self.stream.normal());
        let (fate, stray) = (self.stream.unit(), self.stream.unit());
        // A small rotation without sine and cosine.
        let jitter = Complex::new(1.0, self.level * self.params.jitter_rad * jitter);
        let direction = ahead(UnitComplex::new_normalize(jitter) * direction);
        let dropout = self.level * self.params.dropouts;
        if fate < dropout {
            return None;
        }
        if fate < dropout + self.level * self.params.outliers {
            return Some(nearest_m + stray * (range_m - nearest_m));
        }
        let truth = ray::cast(terrain, origin, direction, range_m)?;
        let deviation = self.level * (self.params.noise_m + self.params.noise_share * truth);
        let range = truth * self.scale + self.offset + deviation * noise;
        (nearest_m..=range_m).contains(&range).then_some(range)
    }
}

/// The rotation by an angle in radians.
fn rotation(angle_rad: f64) -> UnitComplex<f64> {
    let (sine, cosine) = libm::sincos(angle_rad);
    UnitComplex::new_unchecked(Complex::new(cosine, sine))
}
