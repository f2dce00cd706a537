//! Eligibility traces of Sarsa(lambda).

use crate::agent::model::transitions::Experience;
use crate::agent::tabular::table::Table;
use xcs::{Action, Percept};

/// The eligibility of each pair of this episode (replacing traces).
#[derive(Debug, Clone, Default)]
pub(in crate::agent) struct Traces {
    pairs: Vec<(Percept, Action, f64)>,
}

impl Traces {
    /// Traces weaker than this are dropped.
    const NEGLIGIBLE: f64 = 1e-4;

    /// Performs one Sarsa(lambda) update. `next` is the action chosen after the transition; `decay`
    /// is gamma times lambda.
    pub(super) fn learn(
        &mut self,
        table: &mut Table,
        transition: &Experience,
        next: Option<Action>,
        [alpha, gamma, decay]: [f64; 3],
    ) {
        let (percept, action) = (transition.percept, transition.action);
        let after = transition.next.zip(next);
        let after = after.map_or(0.0, |(percept, action)| table.get(&percept, action));
        let td_error = transition.reward + gamma * after - table.get(&percept, action);
        self.pairs.retain(|(p, a, _)| (*p, *a) != (percept, action));
        self.pairs.push((percept, action, 1.0));
        for (percept, action, trace) in &mut self.pairs {
            *table.entry(*percept, *action) += alpha * td_error * *trace;
            *trace *= decay;
        }
        self.pairs.retain(|(.., trace)| *trace > Self::NEGLIGIBLE);
    }

    /// Clears all traces at the end of an episode.
    pub fn clear(&mut self) {
        self.pairs.clear();
    }
}
