//! A step-threshold that tightens with slack, so that a detour can still finish.

use serde::{Deserialize, Serialize};

use super::params::PlusParams;

/// The most steps of an episode (Eq. 10, with slack).
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct StepThreshold {
    learns: bool,
    slack: f64,
    rate: f64,
    threshold: f64,
}

/// More steps than any setting allows.
const MOST_STEPS: f64 = 1e6;

impl StepThreshold {
    /// Can this mechanism, read from a file, stand for one that began as `fresh`?
    pub fn descends_from(&self, fresh: &Self) -> bool {
        (self.learns, self.slack, self.rate) == (fresh.learns, fresh.slack, fresh.rate)
            && (1.0..=MOST_STEPS).contains(&self.threshold)
    }

    pub fn new(first: u32, rate: f64, params: &PlusParams) -> Self {
        Self {
            learns: params.learning_step_threshold,
            slack: params.slack,
            rate,
            threshold: f64::from(first),
        }
    }

    /// The whole steps that the threshold allows.
    pub fn steps(&self) -> u32 {
        self.threshold as u32
    }

    /// Moves toward `slack` times the steps of a success, when the threshold is larger.
    pub fn learn(&mut self, steps: usize) {
        let target = self.slack * steps as f64;
        if self.learns && self.threshold > target {
            self.threshold += self.rate * (target - self.threshold);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_tightens_toward_slack_times_the_success_and_no_further() {
        let params = PlusParams {
            slack: 2.0,
            ..PlusParams::default()
        };
        let mut threshold = StepThreshold::new(50, 0.2, &params);
        threshold.learn(10);
        assert_eq!(threshold.steps(), 44); // 50 + 0.2 (20 - 50)
        (0..1000).for_each(|_| threshold.learn(10));
        assert_eq!(threshold.steps(), 20);
    }
}
