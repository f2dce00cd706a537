//! Value iteration over what is remembered.

use serde::{Deserialize, Serialize};

use super::transitions::Transitions;
use xcs::{Action, MAX_ACTIONS};

/// Value iteration ends when no value changes by more than this, in units of reward ...
const PRECISION: f64 = 1e-9;
/// ... or after this many sweeps.
const MOST_SWEEPS: u32 = 1_000;

/// The value of each action, by the number of the percept.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Values(Vec<[f64; MAX_ACTIONS]>);

impl Values {
    /// The value of a pair; `None` for percepts that were not met when the values were planned.
    pub fn get(&self, percept: usize, action: Action) -> Option<f64> {
        self.0.get(percept).map(|row| row[action.index()])
    }
}

/// What is believed of a pair that is not known.
#[derive(Debug, Clone, Copy)]
pub enum Belief {
    /// What it is worth.
    Worth(f64),
    /// The reward, and the number of the percept that follows.
    LeadsTo(f64, usize),
}

/// A pair whose value follows from those of others.
type Open = (usize, Action, Option<(f64, usize)>);

/// How values are planned: pairs that were tried `known_after` times by what followed them, all
/// others by what is believed of them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Planner {
    pub actions: usize,
    pub known_after: u32,
    pub gamma: f64,
}

impl Planner {
    /// Plans anew, with what is believed of pairs that are not known.
    pub fn plan(&self, memory: &Transitions, believed: impl Fn(usize, Action) -> Belief) -> Values {
        let mut values = Values(vec![[0.0; MAX_ACTIONS]; memory.percepts().len()]);
        let mut open = Vec::new();
        for percept in 0..memory.percepts().len() {
            for action in Action::all(self.actions) {
                if memory.outcomes(percept, action).tries() >= self.known_after {
                    open.push((percept, action, None));
                    continue;
                }
                match believed(percept, action) {
                    Belief::Worth(worth) => values.0[percept][action.index()] = worth,
                    Belief::LeadsTo(reward, to) => open.push((percept, action, Some((reward, to)))),
                }
            }
        }
        // Backward in the order of discovery, because goals are found last.
        open.reverse();
        for _ in 0..MOST_SWEEPS {
            if self.sweep(memory, &open, &mut values) < PRECISION {
                break;
            }
        }
        values
    }

    /// Updates every pair by what followed it (Bellman's equation), or is believed to follow; gives
    /// the greatest change.
    fn sweep(&self, memory: &Transitions, open: &[Open], values: &mut Values) -> f64 {
        let mut change: f64 = 0.0;
        for &(percept, action, believed) in open {
            let value = |reward, next| reward + self.gamma * self.after(values, next);
            let outcomes = memory.outcomes(percept, action);
            let value = match believed {
                Some((reward, to)) => value(reward, Some(to)),
                None => outcomes.mean(|o| value(o.reward, o.next)),
            };
            let old = &mut values.0[percept][action.index()];
            change = change.max((value - *old).abs());
            *old = value;
        }
        change
    }

    fn after(&self, values: &Values, next: Option<usize>) -> f64 {
        let best = |row: &[f64; MAX_ACTIONS]| {
            row[..self.actions]
                .iter()
                .copied()
                .fold(f64::NEG_INFINITY, f64::max)
        };
        next.map_or(0.0, |number| best(&values.0[number]))
    }
}
