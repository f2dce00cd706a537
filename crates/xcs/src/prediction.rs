//! The prediction array: the value of each action (Eq. 6).

use serde::{Deserialize, Serialize};

use super::classifier::Classifier;
use crate::action::{Action, MAX_ACTIONS};

/// Values that differ by less than this share are nearly equal.
const NEARLY: f64 = 1e-3;

/// The value of each action in one percept. Actions that no rule advocates have no value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PredictionArray {
    value: [Option<f64>; MAX_ACTIONS],
    actions: usize,
}

impl PredictionArray {
    /// Creates an array for `actions` actions without values.
    pub fn new(actions: usize) -> Self {
        Self {
            value: [None; MAX_ACTIONS],
            actions: actions.min(MAX_ACTIONS),
        }
    }

    /// Sets the value of an action; does nothing from [`MAX_ACTIONS`] on.
    pub fn set(&mut self, action: Action, value: f64) {
        if let Some(old) = self.value.get_mut(action.index()) {
            *old = Some(value);
        }
    }

    /// Returns the value of an action; `None` if no rule advocates it.
    pub fn get(&self, action: Action) -> Option<f64> {
        self.value.get(action.index()).copied().flatten()
    }

    /// Returns the value of every action, in the order of the actions.
    pub fn as_slice(&self) -> &[Option<f64>] {
        &self.value[..self.actions]
    }

    /// Returns the greatest value; `None` if no action has a value.
    pub fn greatest(&self) -> Option<f64> {
        self.as_slice().iter().flatten().copied().reduce(f64::max)
    }

    /// Returns true if the value of an action is the greatest one, or lower by at most a thousandth of it. In mazes, the
    /// bonus for time in the reward of a success (Eq. 7) makes such differences.
    pub fn is_nearly_best(&self, action: Action) -> bool {
        let values = self.get(action).zip(self.greatest());
        values.is_some_and(|(value, greatest)| value >= greatest - NEARLY * greatest.abs())
    }

    /// Returns all actions with the greatest value.
    pub fn best_actions(&self) -> impl Iterator<Item = Action> + Clone + '_ {
        let greatest = self.greatest();
        Action::all(self.actions)
            .filter(move |&action| greatest.is_some() && self.get(action) == greatest)
    }
}

/// The sums that action values are computed from.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct PredictionSums {
    /// By action, up to the highest one added: the sum of fitness-weighted predictions, and the sum of fitness.
    sums: Vec<(f64, f64)>,
}

impl PredictionSums {
    /// Adds a matching rule.
    #[inline]
    pub fn add<C>(&mut self, rule: &Classifier<C>) {
        let at = rule.action.index();
        if at >= self.sums.len() {
            self.sums.resize(at + 1, (0.0, 0.0));
        }
        let (weighted, fitness) = &mut self.sums[at];
        *weighted += rule.prediction * rule.fitness;
        *fitness += rule.fitness;
    }

    /// Forgets all rules.
    pub(super) fn clear(&mut self) {
        self.sums.clear();
    }

    /// Returns the value of one action, computed as in [`Self::array`]; `None` if no rule advocates it.
    pub fn value(&self, action: Action, over_match_set: bool) -> Option<f64> {
        let &(weighted, own) = self.sums.get(action.index())?;
        let total = match over_match_set {
            true => self.sums.iter().map(|(_, fitness)| fitness).sum(),
            false => own,
        };
        (own > 0.0).then(|| weighted / total)
    }

    /// Returns those of `actions` actions that have the greatest value; none if no action has a value.
    pub(super) fn best(&self, actions: usize, over_match_set: bool) -> Vec<Action> {
        let value = |action| self.value(action, over_match_set);
        let greatest = Action::all(actions).filter_map(value).reduce(f64::max);
        let is_best = |&action: &Action| greatest.is_some() && value(action) == greatest;
        Action::all(actions).filter(is_best).collect()
    }

    /// Returns the fitness-weighted mean prediction of each of `actions` actions. As printed, Eq. 6
    /// divides by the fitness of all of \[M\] (`over_match_set`). XCS divides by the fitness of the
    /// rules with the action.
    pub fn array(&self, actions: usize, over_match_set: bool) -> PredictionArray {
        let mut array = PredictionArray::new(actions);
        for (action, value) in Action::all(actions).zip(&mut array.value) {
            *value = self.value(action, over_match_set);
        }
        array
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::condition::Condition;
    use crate::params::Params;

    #[test]
    fn ties_are_all_best_and_absent_actions_never_are() {
        let [north, east, south]: [Action; 3] = [0, 1, 2].map(|i| Action::new(i).unwrap());
        let mut array = PredictionArray::new(4);
        assert_eq!(array.best_actions().count(), 0);
        array.set(north, -5.0);
        array.set(east, -5.0);
        array.set(south, -6.0);
        assert_eq!(array.best_actions().collect::<Vec<_>>(), [north, east]);
        assert_eq!(array.greatest(), Some(-5.0));
    }

    #[test]
    fn the_fitness_of_all_matching_rules_includes_that_of_wide_actions() {
        let rule = |action: Action, fitness| Classifier {
            prediction: 6.0,
            fitness,
            ..Classifier::<Condition>::new("#".parse().unwrap(), action, 0, &Params::default())
        };
        let (narrow, wide) = (Action::new(0).unwrap(), Action::new(MAX_ACTIONS).unwrap());
        let mut sums = PredictionSums::default();
        sums.add(&rule(narrow, 1.0));
        sums.add(&rule(wide, 2.0));
        // 6 * 1 / (1 + 2), and 6 * 2 / (1 + 2).
        assert_eq!(sums.value(narrow, true), Some(2.0));
        assert_eq!(sums.value(wide, true), Some(4.0));
        assert_eq!(sums.value(narrow, false), Some(6.0), "control");
    }
}
