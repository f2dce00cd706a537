//! A plan in place of rules.

use serde::{Deserialize, Serialize};

use crate::agent::estimator::map::state_map::Map;
use crate::agent::estimator::map::tracker::Tracker;
use crate::agent::planner::rtdp_bel::BeliefPlanner;
use xcs::PredictionArray;

/// A map and the plan on it: enough to choose actions without rules.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "ReadPlan")]
pub struct BeliefPlan {
    pub map: Map,
    pub planner: BeliefPlanner,
}

/// A plan as read from a file, not yet validated.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ReadPlan {
    map: Map,
    planner: BeliefPlanner,
}

impl TryFrom<ReadPlan> for BeliefPlan {
    type Error = &'static str;

    fn try_from(read: ReadPlan) -> Result<Self, Self::Error> {
        let ReadPlan { map, planner } = read;
        match planner.belongs_to(&map.pomdp) {
            true => Ok(Self { map, planner }),
            false => Err("the plan does not fit its map"),
        }
    }
}

impl BeliefPlan {
    /// Continues planning for the tracked belief.
    pub fn plan_for(&mut self, tracker: &Tracker) {
        plan_for(&mut self.planner, &self.map, tracker);
    }

    /// Returns the values of the actions for the tracked belief.
    pub fn values(&self, tracker: &Tracker, actions: usize) -> PredictionArray {
        planned_values(&self.planner, &self.map, tracker, actions)
    }
}

/// Plans for the tracked belief until the costs converge, if observations have errors and moves are exact.
/// Observation errors lead to beliefs that no simulated episode visits.
pub fn plan_for(planner: &mut BeliefPlanner, map: &Map, tracker: &Tracker) {
    if map.observation_error > 0.0 && map.pomdp.slip() == 0.0 {
        planner.settle(&map.pomdp, tracker.belief());
    }
}

/// Returns the values of the actions for the tracked belief; without values if the belief is empty.
pub fn planned_values(
    planner: &BeliefPlanner,
    map: &Map,
    tracker: &Tracker,
    actions: usize,
) -> PredictionArray {
    match tracker.belief().is_empty() {
        true => PredictionArray::new(actions),
        false => planner.values(&map.pomdp, tracker.belief()),
    }
}
