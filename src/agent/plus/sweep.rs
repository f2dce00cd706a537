//! Bellman targets for the rules, from remembered transitions.

use crate::agent::model::transitions::Transitions;
use xcs::Xcs;
use xcs::{Action, Percept};

/// A value that moves by less than this, in units of reward, has settled.
const SETTLED: f64 = 1e-9;
/// General rules may never settle; then a sweep ends after this many rounds.
const MOST_ROUNDS: u32 = 200;

/// The mean over all remembered outcomes of reward plus discounted greatest worth after it.
pub(super) fn target(
    xcs: &Xcs,
    memory: &Transitions,
    percept: usize,
    action: Action,
    gamma: f64,
) -> f64 {
    memory.outcomes(percept, action).mean(|outcome| {
        let after = outcome.next.map(|next| &memory.percepts()[next]);
        outcome.reward + gamma * greatest(xcs, after)
    })
}

/// The greatest worth of a percept; 0 at a goal, and where nothing is known.
fn greatest(xcs: &Xcs, percept: Option<&Percept>) -> f64 {
    let worth = percept.and_then(|percept| xcs.experienced_worth(percept).greatest());
    worth.unwrap_or(0.0)
}

/// Updates the rules of a pair toward its target; gives how far their worth was from it.
pub(super) fn update(
    xcs: &mut Xcs,
    memory: &Transitions,
    (percept, action): (usize, Action),
    gamma: f64,
    beta: f64,
) -> f64 {
    let target = target(xcs, memory, percept, action, gamma);
    let percept = &memory.percepts()[percept];
    let present = xcs.experienced_worth(percept).get(action);
    let surprise = present.map_or(f64::INFINITY, |worth| (target - worth).abs());
    if surprise >= SETTLED {
        let set = xcs.matching_action_set(percept, action);
        xcs.update(&set, target, beta);
    }
    surprise
}

/// Sweeps backward over all that is remembered, again and again, until the values settle.
pub(super) fn sweep(xcs: &mut Xcs, memory: &Transitions, gamma: f64, beta: f64) {
    for _ in 0..MOST_ROUNDS {
        let pairs = memory.tried().iter().rev();
        let surprises = pairs.map(|&pair| update(xcs, memory, pair, gamma, beta));
        if surprises.fold(0.0, f64::max) < SETTLED {
            return;
        }
    }
}
