//! The lidar: rotating beams, a few in every step.

use std::ops::Range;

use nalgebra::{Complex, UnitComplex, Vector2};

use super::{Moment, Terrain, ahead, ray};
use crate::readings::TOO_NEAR;
use crate::{LidarParams, Return};
use xcs::random::Stream;

/// Simulation steps per second.
const STEPS_PER_S: u64 = 20;
/// The rate of the lidar is counted in millionths of a hertz.
const PER_HZ: f64 = 1e6;

/// The beams per simulation step as a fraction, so that beams are numbered without rounding.
#[derive(Debug, Clone, Copy)]
struct Pace {
    beams: u64,
    /// The denominator of the fraction.
    steps: u64,
}

impl Pace {
    fn new(params: &LidarParams) -> Self {
        Self {
            beams: u64::from(params.beams) * (params.rate_hz * PER_HZ).round() as u64,
            steps: STEPS_PER_S * PER_HZ as u64,
        }
    }

    /// Returns the numbers of the beams of a step, counted since the trial began.
    fn numbers(self, step: u64) -> Range<u64> {
        let sent_before = |step: u64| {
            let beams = u128::from(step) * u128::from(self.beams);
            beams.div_ceil(u128::from(self.steps)) as u64
        };
        sent_before(step)..sent_before(step + 1)
    }

    /// Returns the moment during the step when a beam is sent, from 0 to below 1.
    fn moment(self, step: u64, number: u64) -> f64 {
        let [step, number] = [step, number].map(u128::from);
        let late = number * u128::from(self.steps) - step * u128::from(self.beams);
        late as f64 / self.beams as f64
    }
}

/// A lidar that turns at a constant rate. Each beam draws the same count of random numbers.
#[derive(Debug, Clone)]
pub(super) struct Lidar {
    params: LidarParams,
    /// The directions of a whole turn.
    bearings: Vec<UnitComplex<f64>>,
    pace: Pace,
    scale: f64,
    offset: f64,
    level: f64,
    pub(super) stream: Stream,
}

impl Lidar {
    /// Creates the lidar of the robot with `stream`, at a noise level.
    pub(super) fn new(params: &LidarParams, level: f64, mut stream: Stream) -> Self {
        Self {
            bearings: params.bearings(),
            pace: Pace::new(params),
            scale: 1.0 + level * params.scale * stream.normal(),
            offset: level * params.offset_m * stream.normal(),
            level,
            params: params.clone(),
            stream,
        }
    }

    /// Measures the beams of a step during which the robot turns by `turned_rad`, in chronological
    /// order.
    pub(super) fn scan(
        &mut self,
        terrain: &impl Terrain,
        moment: &Moment<'_>,
        turned_rad: f64,
        beams: &mut Vec<Return>,
    ) {
        beams.clear();
        if !self.params.fitted {
            return;
        }
        let way = moment.after.translation.vector - moment.before.translation.vector;
        for number in self.pace.numbers(moment.step) {
            let share = self.pace.moment(moment.step, number);
            let origin = moment.before.translation.vector + share * way;
            let heading = moment.before.rotation * rotation(share * turned_rad);
            let number = (number % self.bearings.len() as u64) as u32;
            let bearing = self.bearings[number as usize];
            beams.push(Return {
                number,
                moment: share,
                bearing,
                range_m: self.measure(terrain, origin, heading * bearing),
            });
        }
    }

    /// Measures one beam from `origin`.
    fn measure(
        &mut self,
        terrain: &impl Terrain,
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
        match range {
            range if range < nearest_m => Some(TOO_NEAR),
            range => Some(range).filter(|&range| range <= range_m),
        }
    }
}

/// Returns the rotation by an angle in radians.
fn rotation(angle_rad: f64) -> UnitComplex<f64> {
    let (sine, cosine) = libm::sincos(angle_rad);
    UnitComplex::new_unchecked(Complex::new(cosine, sine))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Isometry2;

    /// A single free cell.
    struct Closet;

    impl Terrain for Closet {
        fn pixel_m(&self) -> f64 {
            1.0
        }

        fn is_solid(&self, col: i32, row: i32) -> bool {
            (col, row) != (0, 0)
        }

        fn is_marked(&self, _: Vector2<f64>) -> bool {
            false
        }
    }

    /// Counts the beams of `steps` steps, and requires that each is the next one of its turn.
    fn beams_in_order(beams: u32, rate_hz: f64, steps: u64) -> u64 {
        let params = LidarParams {
            beams,
            rate_hz,
            ..LidarParams::default()
        };
        let mut lidar = Lidar::new(&params, 0.0, Stream::new(1, 8_u64));
        let (mut returns, mut count) = (Vec::new(), 0);
        let pose = Isometry2::translation(0.5, 0.5);
        for step in 0..steps {
            let moment = Moment {
                step,
                before: pose,
                after: pose,
                travel_m: [0.0; 2],
                pushes: &[],
            };
            lidar.scan(&Closet, &moment, 0.0, &mut returns);
            for beam in &returns {
                let next = lidar.bearings[(count % u64::from(beams)) as usize];
                assert_eq!(beam.bearing, next, "beam {count} in step {step}");
                assert!((0.0..1.0).contains(&beam.moment), "{}", beam.moment);
                count += 1;
            }
        }
        count
    }

    #[test]
    fn a_beam_that_hits_something_too_near_differs_from_one_that_does_not_come_back() {
        let params = LidarParams {
            nearest_m: 0.2,
            range_m: 1.0,
            ..LidarParams::default()
        };
        let mut lidar = Lidar::new(&params, 0.0, Stream::new(1, 8_u64));
        let mut measure =
            |x: f64| lidar.measure(&Closet, Vector2::new(x, 0.5), UnitComplex::identity());
        assert_eq!(measure(0.75), Some(0.25));
        assert_eq!(measure(0.85), Some(f64::NEG_INFINITY));
        assert_eq!(
            measure(-0.5),
            None,
            "control: farther than the lidar measures"
        );
    }

    #[test]
    fn no_beam_is_lost_or_repeated_at_any_rate() {
        assert_eq!(beams_in_order(32, 5.5, 200_000), 1_760_000);
        assert_eq!(beams_in_order(360, 5.0, 10_000), 900_000);
        assert_eq!(beams_in_order(7, 1.1, 200_000), 77_000);
    }

    #[test]
    fn the_default_lidar_sends_eight_beams_a_step_at_even_times() {
        assert_eq!(beams_in_order(32, 5.0, 1_000), 8_000);
        let pace = Pace::new(&LidarParams::default());
        let moments: Vec<f64> = pace.numbers(3).map(|n| pace.moment(3, n)).collect();
        assert_eq!(pace.numbers(3), 24..32);
        assert_eq!(moments[..3], [0.0, 0.125, 0.25]);
    }
}
