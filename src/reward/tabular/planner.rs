//! R-max (Brafman and Tennenholtz 2002): what is unknown is believed to be as good as can be.

use super::model::Model;
use super::table::Table;
use crate::signal::{Action, Percept};

/// Value iteration ends when no value changes by more than this, in units of reward ...
const PRECISION: f64 = 1e-9;
/// ... or after this many sweeps.
const MOST_SWEEPS: u32 = 10_000;

/// How the model is turned into values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Planner {
    /// Tries after which a pair counts as known.
    pub known_after: u32,
    /// The value of a pair that is not known.
    pub unknown: f64,
    pub gamma: f64,
}

impl Planner {
    /// The values of all pairs by value iteration over the known ones.
    pub fn plan(&self, model: &Model, actions: usize) -> Table {
        let mut table = Table::new(actions);
        for ((percept, _), _) in model.pairs() {
            for action in Action::all(actions) {
                *table.entry(*percept, action) = self.unknown;
            }
        }
        for _ in 0..MOST_SWEEPS {
            if self.sweep(model, &mut table) < PRECISION {
                break;
            }
        }
        table
    }

    /// Updates every known pair once; gives the greatest change.
    fn sweep(&self, model: &Model, table: &mut Table) -> f64 {
        let mut greatest: f64 = 0.0;
        for ((percept, action), outcomes) in model.pairs() {
            if outcomes.tries() < self.known_after {
                continue;
            }
            let value = outcomes.mean(|reward, next| reward + self.gamma * self.after(table, next));
            let q = table.entry(*percept, *action);
            greatest = greatest.max((value - *q).abs());
            *q = value;
        }
        greatest
    }

    /// The value of a percept: that of its best action; where nothing was tried, the belief.
    fn after(&self, table: &Table, next: Option<&Percept>) -> f64 {
        match next {
            None => 0.0,
            Some(percept) if table.knows(percept) => table.greatest(Some(percept)),
            Some(_) => self.unknown,
        }
    }
}
