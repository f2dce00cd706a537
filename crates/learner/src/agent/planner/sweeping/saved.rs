//! The learned state of a plan.

use std::cmp::Reverse;

use super::{Before, PlannedValues};
use crate::agent::model::return_rules::Counts;
use crate::agent::model::transitions::Transitions;

/// The number of updates allowed, and the percepts that wait for an update, each with the bits of
/// the value that it is queued with.
pub(in crate::agent) type Waiting = (usize, Vec<(u64, Reverse<usize>)>);

/// The values, the waiting updates, the predecessors of each percept, and the counts of the return rules.
pub(in crate::agent) type Saved = (Vec<f64>, Waiting, Before, Counts);

impl PlannedValues {
    /// Returns the learned state: the values, the updates allowed and waiting, the predecessors of
    /// each percept, and the counts of the return rules.
    pub fn kept(&self) -> (&[f64], Waiting, &Before, Counts) {
        let queue = self.queue.clone().into_sorted_vec();
        let waiting = (self.updates, queue);
        (&self.values, waiting, &self.before, self.returns.kept())
    }

    /// Resumes from a learned state; `false` if the state does not fit the percepts of `memory`, or a count is out of
    /// range.
    pub fn resume(
        &mut self,
        (values, waiting, before, returns): Saved,
        memory: &Transitions,
    ) -> bool {
        let known = values.len();
        (self.values, self.before) = (values, before);
        self.stale = vec![false; known];
        let met = memory.percepts().len();
        let mut pairs = self.before.iter().flatten();
        self.returns.allow(memory.slips());
        self.returns.resume(returns)
            && known <= met
            && self.before.len() == known
            && self
                .values
                .iter()
                .all(|value| value.is_finite() && *value >= 0.0)
            && pairs.all(|&(percept, action)| percept < known && action.index() < self.actions)
            && self.resume_waiting(waiting)
    }

    /// Resumes the waiting updates; `false` if a percept is unknown or waits twice.
    fn resume_waiting(&mut self, (updates, queue): Waiting) -> bool {
        self.updates = updates;
        for &(_, Reverse(percept)) in &queue {
            match self.stale.get_mut(percept) {
                Some(stale) if !*stale => *stale = true,
                _ => return false,
            }
        }
        self.queue = queue.into();
        true
    }

    /// Returns the percepts whose example may have changed.
    pub fn touched(&self) -> &[usize] {
        &self.touched
    }

    /// Resumes the percepts whose example may have changed; `false` if one has no value.
    pub fn resume_touched(&mut self, touched: Vec<usize>) -> bool {
        self.touched = touched;
        self.touched
            .iter()
            .all(|&percept| percept < self.values.len())
    }
}
