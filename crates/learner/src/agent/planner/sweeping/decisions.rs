//! The decisions of a plan: action values, and the best actions for the replay.

use crate::agent::model::transitions::Transitions;
use crate::agent::planner::sweeping::PlannedValues;
use xcs::{Action, ByAction, LabelledExample};

/// Actions whose values differ by less than this share are equally good.
const TIE: f64 = 1e-7;

impl PlannedValues {
    /// Returns the examples that may have changed since the last call, by the number of the
    /// percept.
    pub fn news(&mut self, model: &Transitions) -> Vec<(usize, LabelledExample)> {
        let mut touched = std::mem::take(&mut self.touched);
        touched.sort_unstable();
        touched.dedup();
        let labelled_examples = touched
            .into_iter()
            .filter(|&percept| self.values[percept] > 0.0);
        labelled_examples
            .map(|percept| (percept, self.labelled_example(model, percept)))
            .collect()
    }

    /// Returns the values of the actions in a percept. The best actions have exactly equal values. Empty if no path
    /// to a goal is known.
    pub fn action_values(
        &self,
        model: &Transitions,
        percept: usize,
    ) -> impl Iterator<Item = (Action, f64)> {
        let is_known = self.value(percept) > 0.0;
        let greatest = if is_known {
            self.greatest(model, percept)
        } else {
            0.0
        };
        let actions = Action::all(self.actions).filter(move |_| is_known);
        actions.filter_map(move |action| {
            let value = self.value_of(model, percept, action)?;
            let is_best = value >= greatest * (1.0 - TIE);
            Some((
                action,
                self.floor() + if is_best { greatest } else { value },
            ))
        })
    }

    /// Returns true if an action is one of the best in a percept, as far as known.
    pub fn is_best(&self, model: &Transitions, percept: usize, action: Action) -> bool {
        self.value(percept) > 0.0 && self.labelled_example(model, percept).best[action.index()]
    }

    /// Returns the labelled example of a percept: its best actions.
    fn labelled_example(&self, model: &Transitions, percept: usize) -> LabelledExample {
        let value = self.values[percept];
        // Values of uncertain moves are not settled to the last digit.
        let greatest = match model.slips().any() {
            true => self.greatest(model, percept),
            false => value,
        };
        let mut best = ByAction::default();
        for action in Action::all(self.actions) {
            let own = self.value_of(model, percept, action);
            best[action.index()] = own.is_some_and(|own| own >= greatest * (1.0 - TIE));
        }
        LabelledExample {
            percept: model.percepts()[percept],
            best,
        }
    }
}
