//! Exploration and exploitation.

use xcs::Action;
use xcs::PredictionArray;
use xcs::random::Stream;

/// Chooses a random action with probability p_explr, otherwise one of the best.
#[derive(Debug, Clone, PartialEq)]
pub struct Explorer {
    probability: f64,
    stream: Stream,
}

impl Explorer {
    /// Creates an explorer that draws from `stream`. A probability of 0 is purely greedy.
    pub fn new(probability: f64, stream: Stream) -> Self {
        Self {
            probability,
            stream,
        }
    }

    /// Sets the probability of exploring.
    pub fn set_probability(&mut self, probability: f64) {
        self.probability = probability;
    }

    /// Returns an action, and whether it was chosen to explore.
    pub fn choose(&mut self, values: &PredictionArray) -> (Action, bool) {
        let all = Action::all(values.as_slice().len());
        self.choose_among(values, all)
    }

    /// Like [`choose`](Self::choose), but explores only actions that have a value, if there are
    /// any.
    pub fn choose_advocated(&mut self, values: &PredictionArray) -> (Action, bool) {
        if values.greatest().is_none() {
            return self.choose(values);
        }
        let all = Action::all(values.as_slice().len());
        self.choose_among(values, all.filter(|&action| values.get(action).is_some()))
    }

    fn choose_among(
        &mut self,
        values: &PredictionArray,
        tried: impl Iterator<Item = Action> + Clone,
    ) -> (Action, bool) {
        let explores = self.stream.chance(self.probability);
        let action = match explores {
            true => self.among(tried),
            false => self.exploit(values),
        };
        (action, explores)
    }

    /// Returns one of the best actions, or any action if no value is known. Ties are broken at
    /// random.
    pub fn exploit(&mut self, values: &PredictionArray) -> Action {
        exploit(values, &mut self.stream)
    }

    /// Returns one of the given actions, all equally likely.
    pub fn among(&mut self, actions: impl Iterator<Item = Action> + Clone) -> Action {
        among(actions, &mut self.stream)
    }
}

/// Returns one of the best actions, or any action if no value is known. Ties are broken at random.
pub fn exploit(values: &PredictionArray, stream: &mut Stream) -> Action {
    match values.greatest() {
        Some(_) => among(values.best_actions(), stream),
        None => among(Action::all(values.as_slice().len()), stream),
    }
}

fn among(actions: impl Iterator<Item = Action> + Clone, stream: &mut Stream) -> Action {
    let chosen = stream.below(actions.clone().count().max(1));
    let action = actions.clone().nth(chosen);
    action.expect("there is at least one action to choose from")
}

#[cfg(test)]
mod tests {
    use super::*;
    use xcscr_robot::streams::StreamName;

    #[test]
    fn only_actions_with_a_value_are_explored_unless_there_are_none() {
        let mut explorer = Explorer::new(1.0, Stream::new(1, StreamName::Exploration));
        let mut values = PredictionArray::new(4);
        let mut tried = |values: &PredictionArray| {
            let mut counts = [0; 4];
            for _ in 0..400 {
                counts[explorer.choose_advocated(values).0.index()] += 1;
            }
            counts.map(|count| count > 0)
        };
        assert_eq!(tried(&values), [true; 4]);
        values.set(Action::new(1).unwrap(), -1.0);
        values.set(Action::new(3).unwrap(), 5.0);
        assert_eq!(tried(&values), [false, true, false, true]);
    }
}
