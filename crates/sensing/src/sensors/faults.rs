//! Sensor faults: the readings of broken sensors.

use crate::{FaultParams, Readings, Return, STEP_S};

/// The faults of a robot, and when they start. Faults draw no random numbers, so the readings of
/// all working sensors are the same with and without faults.
#[derive(Debug, Clone)]
pub(super) struct Faults {
    params: FaultParams,
    /// The cosine of half of the dead sector.
    dead_above: f64,
    /// The number of the episode, from 1; 0 before the first one.
    episode: u32,
    /// The drift of the gyro, in radians per step.
    drift_rad: f64,
}

impl Faults {
    /// Creates the faults, which start later.
    pub(super) fn new(params: &FaultParams) -> Self {
        let half = (params.dead_sector_deg / 2.0).to_radians();
        Self {
            dead_above: libm::cos(half),
            params: params.clone(),
            episode: 0,
            drift_rad: 0.0,
        }
    }

    /// Begins an episode.
    pub(super) fn begin_episode(&mut self, episode: u32) {
        self.episode = episode;
    }

    /// Returns true if the faults have started.
    pub(super) fn have_started(&self) -> bool {
        self.episode >= self.params.from_episode
    }

    /// Removes the ranges of the beams in the dead sector.
    pub(super) fn blind(&self, beams: &mut [Return]) {
        if self.params.dead_sector_deg == 0.0 || !self.have_started() {
            return;
        }
        let is_dead = |beam: &&mut Return| beam.bearing.re >= self.dead_above;
        beams
            .iter_mut()
            .filter(is_dead)
            .for_each(|beam| beam.range_m = None);
    }

    /// Replaces the readings of broken sensors.
    pub(super) fn distort(&mut self, readings: &mut Readings<'_>) {
        if !self.have_started() {
            return;
        }
        self.drift_rad += self.params.gyro_drift_radps2 * STEP_S * STEP_S;
        readings.turned_rad = readings.turned_rad.map(|turn| turn + self.drift_rad);
        if self.params.stuck_encoder {
            readings.rolled_m[0] = 0.0;
        }
        if self.params.dead_bumper {
            readings.bumped[0] = false;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Complex, UnitComplex};

    fn beam(x: f64, y: f64) -> Return {
        Return {
            number: 0,
            moment: 0.5,
            bearing: UnitComplex::new_unchecked(Complex::new(x, y)),
            range_m: Some(1.0),
        }
    }

    /// Returns the readings in an episode when all faults start in the second episode.
    fn readings_in(episode: u32) -> ([f64; 2], f64, [bool; 2], Vec<bool>) {
        let mut faults = Faults::new(&FaultParams {
            from_episode: 2,
            dead_sector_deg: 90.0,
            stuck_encoder: true,
            gyro_drift_radps2: 0.4,
            dead_bumper: true,
        });
        faults.begin_episode(episode);
        let mut beams = [
            beam(1.0, 0.0),
            beam(0.6, 0.8),
            beam(0.8, -0.6),
            beam(-1.0, 0.0),
        ];
        faults.blind(&mut beams);
        let mut readings = Readings {
            rolled_m: [0.1, 0.2],
            turned_rad: Some(0.0),
            told: None,
            bumped: [true; 2],
            over_marker: false,
            beams: &beams,
        };
        faults.distort(&mut readings);
        let came_back = beams.iter().map(|beam| beam.range_m.is_some()).collect();
        (
            readings.rolled_m,
            readings.turned_rad.unwrap(),
            readings.bumped,
            came_back,
        )
    }

    #[test]
    fn broken_sensors_give_wrong_readings_from_their_episode_on() {
        let (rolled, turned, bumped, came_back) = readings_in(2);
        assert_eq!((rolled, bumped), ([0.0, 0.2], [false, true]));
        assert!((turned - 0.001).abs() < 1e-12, "{turned}");
        assert_eq!(came_back, [false, true, false, true]);
    }

    #[test]
    fn faults_change_nothing_before_their_episode() {
        let intact = ([0.1, 0.2], 0.0, [true; 2], vec![true; 4]);
        assert_eq!(readings_in(1), intact);
    }
}
