//! The learning step-threshold mechanism (Eq. 10).

use crate::agent::credit::params::Params;

/// The maximum number of steps of an episode. It shrinks toward the lengths of successful episodes.
#[derive(Debug, Clone)]
pub(super) struct StepThreshold {
    learns: bool,
    rate: f64,
    threshold: f64,
}

impl StepThreshold {
    pub fn new(params: &Params) -> Self {
        Self {
            learns: params.learning_step_threshold,
            rate: params.beta_success,
            threshold: f64::from(params.step_threshold),
        }
    }

    /// Returns the threshold in whole steps, rounded down.
    pub fn steps(&self) -> u32 {
        self.threshold as u32
    }

    /// Applies Eq. 10 after a success of `steps` steps, if the threshold is larger.
    pub fn learn(&mut self, steps: usize) {
        let steps = steps as f64;
        if self.learns && self.threshold > steps {
            self.threshold += self.rate * (steps - self.threshold);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equation_10_moves_the_threshold_a_fifth_of_the_way() {
        let mut threshold = StepThreshold::new(&Params::default());
        threshold.learn(10);
        assert_eq!(threshold.steps(), 42); // 50 + 0.2 (10 - 50)
        threshold.learn(12);
        assert_eq!(threshold.steps(), 36); // 42 + 0.2 (12 - 42)
    }

    #[test]
    fn it_never_falls_below_the_shortest_success() {
        let mut threshold = StepThreshold::new(&Params::default());
        (0..1000).for_each(|_| threshold.learn(10));
        assert_eq!(threshold.steps(), 10);
    }

    #[test]
    fn it_does_not_change_when_switched_off() {
        let params = Params {
            learning_step_threshold: false,
            ..Params::default()
        };
        let mut threshold = StepThreshold::new(&params);
        threshold.learn(10);
        assert_eq!(threshold.steps(), 50);
    }
}
