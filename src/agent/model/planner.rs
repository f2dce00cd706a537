//! Value iteration over what is remembered.

use serde::{Deserialize, Serialize};

use super::transitions::{Outcomes, Transitions};
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
struct Open<'a> {
    percept: usize,
    action: usize,
    leads_to: Leads<'a>,
}

/// What follows a pair.
enum Leads<'a> {
    /// What was seen to follow.
    Seen(&'a Outcomes),
    /// The reward and the percept that are believed to follow.
    Believed(f64, usize),
}

/// Values while they are planned, and the greatest value of each percept.
struct Draft {
    values: Vec<[f64; MAX_ACTIONS]>,
    greatest: Vec<f64>,
}

impl Draft {
    /// Changes the value of a pair, where a percept has so many actions; gives by how much.
    fn set(&mut self, percept: usize, action: usize, value: f64, actions: usize) -> f64 {
        let row = &mut self.values[percept];
        let change = (value - row[action]).abs();
        if change > 0.0 {
            row[action] = value;
            let mut greatest = f64::NEG_INFINITY;
            for &value in &row[..actions] {
                greatest = greatest.max(value);
            }
            self.greatest[percept] = greatest;
        }
        change
    }
}

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
        let met = memory.percepts().len();
        let mut draft = Draft {
            values: vec![[0.0; MAX_ACTIONS]; met],
            greatest: vec![0.0; met],
        };
        let mut open = Vec::new();
        for percept in 0..met {
            for action in Action::all(self.actions) {
                let outcomes = memory.outcomes(percept, action);
                let leads_to = if outcomes.tries() >= self.known_after {
                    Leads::Seen(outcomes)
                } else {
                    match believed(percept, action) {
                        Belief::LeadsTo(reward, to) => Leads::Believed(reward, to),
                        Belief::Worth(worth) => {
                            draft.set(percept, action.index(), worth, self.actions);
                            continue;
                        }
                    }
                };
                let action = action.index();
                open.push(Open {
                    percept,
                    action,
                    leads_to,
                });
            }
        }
        // Backward in the order of discovery, because goals are found last.
        open.reverse();
        for _ in 0..MOST_SWEEPS {
            if self.sweep(&open, &mut draft) < PRECISION {
                break;
            }
        }
        Values(draft.values)
    }

    /// Updates every pair by what followed it (Bellman's equation), or is believed to follow; gives
    /// the greatest change.
    fn sweep(&self, open: &[Open<'_>], draft: &mut Draft) -> f64 {
        let mut change: f64 = 0.0;
        for pair in open {
            let after = |next: Option<usize>| next.map_or(0.0, |number| draft.greatest[number]);
            let value = match pair.leads_to {
                Leads::Seen(outcomes) => outcomes.mean(|o| o.reward + self.gamma * after(o.next)),
                Leads::Believed(reward, to) => reward + self.gamma * draft.greatest[to],
            };
            change = change.max(draft.set(pair.percept, pair.action, value, self.actions));
        }
        change
    }
}
