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
        let all = || Action::all(worth.as_slice().len()).collect::<Vec<_>>();
        let best: Vec<Action> = worth.best_actions().collect();
        let among = if explores || best.is_empty() {
            all()
        } else {
            best
        };
        let action = *self
            .stream
            .choose(&among)
            .expect("a prediction array has at least one action");
        (action, explores)
    }
}
