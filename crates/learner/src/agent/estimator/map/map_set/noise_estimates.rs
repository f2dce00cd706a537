//! Estimates of slip probability and observation error from the episodes of a map set.

use crate::agent::estimator::map::association::Alignment;
use crate::agent::estimator::map::map_set::MapSet;
use crate::agent::estimator::map::noise::NoiseCounts;
use crate::agent::estimator::map::params::MotionPrior;
use crate::agent::estimator::map::place::Vision;
use crate::agent::estimator::map::robot_model::{MapStep, differing, slips};

/// The initial estimates of slip probability and observation error.
pub(super) const FIRST_SLIP: f64 = 0.05;
pub(super) const LEAST_OBSERVATION_ERROR: f64 = 0.0005;
/// Looked-up percepts with a smaller observation error are treated as correct. The estimate for sensed
/// percepts never falls below this.
const NEGLIGIBLE_ERROR: f64 = 0.002;
/// The number of differing cells required before percepts are treated as noisy.
const LEAST_DIFFERING: f64 = 3.0;
/// The prior number of cells shown twice without a difference.
const SHOWN_AT_FIRST: f64 = 50.0;
/// The number of updates of the noise estimates after each episode.
const ESTIMATED: usize = 3;

impl MapSet {
    /// Compares successive percepts of an episode to estimate the observation error.
    pub(super) fn compare(&mut self, steps: &[MapStep]) {
        let differing = differing(steps, &self.robot);
        let fading = 0.99;
        let sums = self.observation_error.iter_mut().zip(differing);
        sums.for_each(|(sum, count)| *sum = *sum * fading + count);
        self.update_observation_error();
    }

    /// Compares successive percepts. Returns true once the observation error exceeds
    /// [`NEGLIGIBLE_ERROR`].
    pub fn notices_noise(&mut self, steps: &[MapStep]) -> bool {
        if self.params.estimates_noise {
            self.compare(steps);
        }
        self.observation_error[0] >= LEAST_DIFFERING
            && self.robot.observation_error > NEGLIGIBLE_ERROR
    }

    fn update_observation_error(&mut self) {
        let [differing, all] = self.observation_error;
        // One of the two percepts was wrong.
        let observation_error = differing / 2.0 / (all + SHOWN_AT_FIRST);
        self.robot.observation_error =
            observation_error.clamp(least_observation_error(self.robot.vision), 0.25);
    }

    /// Estimates slip probability and observation error from all stored episodes. Each estimate depends
    /// on the other one.
    pub(super) fn estimate(&mut self) {
        for _ in 0..ESTIMATED {
            let tally = NoiseCounts::of(self.episodes.iter(), &self.robot);
            (self.slips, self.observation_error) = (tally.slips, tally.differing);
            self.update_robot_model();
            self.update_observation_error();
        }
    }

    /// Returns true if looked-up percepts have observation errors.
    pub(super) fn has_noisy_percepts(&self) -> bool {
        self.robot.vision == Vision::GroundTruth && self.observation_error() > 0.0
    }

    /// Returns the observation error; 0 if looked-up percepts are treated as correct.
    pub(super) fn observation_error(&self) -> f64 {
        match self.robot.vision {
            Vision::GroundTruth if self.robot.observation_error < NEGLIGIBLE_ERROR => 0.0,
            _ => self.robot.observation_error,
        }
    }

    /// Returns the number of slips in an episode. While the motion model is being learned, a deviation
    /// from the expected direction is not necessarily a slip, so the alignment with the map decides.
    pub(super) fn slips_of(&self, steps: &[MapStep], alignment: &Alignment) -> f64 {
        match self.params.motion_model {
            MotionPrior::Known => slips(steps, &self.robot),
            MotionPrior::Learned => alignment.slips,
        }
    }

    /// Updates the slip probability from the latest episodes.
    pub(super) fn update_robot_model(&mut self) {
        let [slips, steps] = self.slips;
        self.robot.slip = ((slips + FIRST_SLIP) / (steps + 1.0)).clamp(1e-4, 0.9);
    }
}

/// Returns the least observation error that is assumed.
pub(super) fn least_observation_error(vision: Vision) -> f64 {
    match vision {
        Vision::GroundTruth => LEAST_OBSERVATION_ERROR,
        Vision::Lidar => NEGLIGIBLE_ERROR,
    }
}
