//! Explore or exploit.

use crate::random::Stream;
use crate::signal::Action;
use crate::xcs::PredictionArray;

/// Chooses actions: with probability p_explr any, otherwise one of the best.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Explorer {
    probability: f64,
    stream: Stream,
}

impl Explorer {
    /// An explorer that draws from `stream`; a probability of 0 is purely greedy.
    pub fn new(probability: f64, stream: Stream) -> Self {
        Self {
            probability,
            stream,
        }
    }

    /// From now on explores with this probability.
    pub fn set_probability(&mut self, probability: f64) {
        self.probability = probability;
    }

    /// An action, and whether it was chosen to explore. Ties are broken by chance.
    pub fn choose(&mut self, worth: &PredictionArray) -> (Action, bool) {
        let explores = self.stream.chance(self.probability);
        let best = if explores { 0 } else { worth.best_actions().count() };
        let action = if best > 0 {
            worth.best_actions().nth(self.stream.below(best))
        } else {
            Action::new(self.stream.below(worth.as_slice().len()))
        };
        let action = action.expect("a prediction array has at least one action");
        (action, explores)
    }
}
