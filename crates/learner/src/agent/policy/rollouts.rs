//! Rules put to the test in imagined episodes in which cells are misread as often as they are.

use crate::agent::estimator::map::place::{CellState, around, percept_of};
use crate::agent::estimator::map::state_map::Map;
use crate::agent::estimator::map::tracker::Tracker;
use crate::agent::explorer::exploit;
use crate::agent::planner::rtdp_bel::BeliefPlanner;
use crate::agent::policy::examples::{MOST_STEPS, Walker};
use xcs::random::Stream;
use xcs::{Percept, Population};

/// The share of the steps that is lost in so many episodes in which the rules choose, and chance where none
/// matches, by what the plan expects of each action.
pub fn rehearse(
    map: &Map,
    planner: &BeliefPlanner,
    rules: &Population,
    episodes: u32,
    stream: &mut Stream,
) -> f64 {
    let (mut steps, mut lost) = (0_u32, 0.0);
    for episode in 0..episodes {
        let mut walker = Walker {
            state: map.begin.unwrap_or(episode % map.starts()),
            tracker: Tracker::default(),
        };
        for _ in 0..MOST_STEPS {
            let Walker { state, tracker } = &mut walker;
            tracker.perceive(map, &observation_error(map, *state, stream));
            let costs = planner.costs(&map.pomdp, tracker.belief());
            let values = rules.sums(&tracker.context(map));
            let values = values.array(map.pomdp.actions(), false);
            let action = exploit(&values, stream);
            steps += 1;
            lost += costs.regret(action, &map.pomdp);
            if walker.arrives(map, action, stream) {
                break;
            }
        }
    }
    lost / f64::from(steps.max(1))
}

/// What is perceived in a state, if each cell may be misread for one of the other two state.
fn observation_error(map: &Map, state: u32, stream: &mut Stream) -> Percept {
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
