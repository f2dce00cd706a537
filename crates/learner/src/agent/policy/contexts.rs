//! Contexts that a robot meets on the maps, for comparing rules.

use crate::agent::estimator::map::state_map::Map;
use crate::agent::estimator::map::tracker::{Felt, Tracker};
use crate::agent::model::pomdp::GOAL;
use xcs::{Action, Percept};

/// Returns the contexts in all states, and the contexts one and two moves from them. Beyond about `most` contexts,
/// moves are followed only from every n-th state.
pub fn contexts(map: &Map, most: usize) -> Vec<Percept> {
    let states = map.pomdp.states();
    let ways = (1 + map.pomdp.actions()).pow(2);
    let stride = (states * ways).div_ceil(most).max(1);
    let mut contexts = Vec::new();
    for state in 0..states as u32 {
        let tracker = Tracker::standing(map, state);
        contexts.push(tracker.context(map));
        if (state as usize).is_multiple_of(stride) {
            add_moves(map, &tracker, state, 2, &mut contexts);
        }
    }
    contexts
}

fn add_moves(map: &Map, from: &Tracker, state: u32, depth: u32, contexts: &mut Vec<Percept>) {
    for action in Action::all(map.pomdp.actions()) {
        let next = map.pomdp.next(state, action);
        if next == GOAL {
            continue;
        }
        let mut tracker = from.clone();
        let felt = Felt {
            bumped: next == state,
            rewarded: map.pays(state, next),
        };
        tracker.act(action, felt);
        tracker.perceive_rightly(map, map.pomdp.percept(next));
        contexts.push(tracker.context(map));
        if depth > 1 {
            add_moves(map, &tracker, next, depth - 1, contexts);
        }
    }
}
