//! A plan in place of rules.

use serde::{Deserialize, Serialize};

use crate::agent::estimator::map::state_map::Map;
use crate::agent::estimator::map::tracker::Tracker;
use crate::agent::planner::rtdp_bel::BeliefPlanner;
use xcs::PredictionArray;

/// Maps, and what was planned on them: enough to choose without rules.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "ReadPlan")]
pub struct BeliefPlan {
    map: Map,
    planner: BeliefPlanner,
}

/// A plan as it stands in a file, which nobody has looked at.
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
            false => Err("the plan is not one for its cell_maps"),
        }
    }
}

impl BeliefPlan {
    /// What was planned on a map.
    pub fn new(map: Map, planner: BeliefPlanner) -> Self {
        Self { map, planner }
    }

    /// The mapped places.
    pub fn map(&self) -> &Map {
        &self.map
    }

    /// The number of beliefs that were planned for.
    pub fn beliefs(&self) -> usize {
        self.planner.beliefs()
    }

    /// Plans on for what is remembered.
    pub fn plan_for(&mut self, tracker: &Tracker) {
        plan_for(&mut self.planner, &self.map, tracker);
    }

    /// What the plan makes of what is remembered.
    pub fn values(&self, tracker: &Tracker, actions: usize) -> PredictionArray {
        planned_values(&self.planner, &self.map, tracker, actions)
    }
}

/// Plans on for what is believed, until nothing changes any more, where cells are misread and moves are
/// exact: what is misread leads to beliefs that no imagined episode comes to.
pub fn plan_for(planner: &mut BeliefPlanner, map: &Map, tracker: &Tracker) {
    if map.observation_error > 0.0 && map.pomdp.slip() == 0.0 {
        planner.settle(&map.pomdp, tracker.belief());
    }
}

/// What a plan makes of what is remembered: no action has a value where nothing is believed.
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
