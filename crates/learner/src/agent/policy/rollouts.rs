//! Roll-outs of rules in simulated episodes with observation errors.

use crate::agent::estimator::map::place::{CellState, around, percept_of};
use crate::agent::estimator::map::state_map::Map;
use crate::agent::estimator::map::tracker::Tracker;
use crate::agent::planner::rtdp_bel::{BeliefPlanner, MOST_SIMULATED_STEPS};
use crate::agent::policy::examples::Walker;
use crate::agent::policy::explorer::exploit;
use xcs::random::Stream;
use xcs::{Percept, Population};

/// Returns the mean regret per step over `episodes` episodes, according to the plan. The rules choose the actions, or
/// chance if none matches.
pub fn roll_out(
    map: &Map,
    planner: &BeliefPlanner,
    rules: &Population,
    episodes: u32,
    stream: &mut Stream,
) -> f64 {
    let (mut steps, mut regret) = (0_u32, 0.0);
    for episode in 0..episodes {
        let mut walker = Walker {
            state: map.begin.unwrap_or(episode % map.starts()),
            tracker: Tracker::default(),
        };
        for _ in 0..MOST_SIMULATED_STEPS {
            let Walker { state, tracker } = &mut walker;
            tracker.perceive(map, &noisy_percept(map, *state, stream));
            let costs = planner.costs(&map.pomdp, tracker.belief());
            let values = rules.sums(&tracker.context(map));
            let values = values.array(map.pomdp.actions(), false);
            let action = exploit(&values, stream);
            steps += 1;
            regret += costs.regret(action, &map.pomdp);
            if walker.arrives(map, action, stream) {
                break;
            }
        }
    }
    regret / f64::from(steps.max(1))
}

/// Draws the percept of a state. Each cell may be observed as one of the other two cell states.
fn noisy_percept(map: &Map, state: u32, stream: &mut Stream) -> Percept {
    let state = around(map.pomdp.percept(state)).map(|state| {
        let others = match state {
            CellState::Free => [CellState::Wall, CellState::Goal],
            CellState::Goal => [CellState::Free, CellState::Wall],
            CellState::Wall | CellState::Hidden => [CellState::Free, CellState::Goal],
        };
        match stream.chance(map.observation_error) {
            true => others[stream.below(others.len())],
            false => state,
        }
    });
    percept_of(&state)
}
