//! Exploration that heads for the least-tried actions.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::agent::credit::Params;
use crate::agent::model::planner::{Belief, Believed, Planner, Values};
use crate::agent::model::transitions::Transitions;
use xcs::PredictionArray;
use xcs::{Action, Percept};

use super::collision_rules::CollisionRules;
use super::return_rules::ReturnRules;

/// Plans over what is remembered, in the belief that an untried action leads straight to the goal
/// unless a collision or a way back is foretold: the nearest promising action becomes the best
/// one, and where nothing promising is nearer than the goal, the goal is. Untried actions of the
/// present percept come first, likely collisions last.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Curiosity {
    planner: Planner,
    /// What an untried action is believed to be worth, and one that bumps.
    goal: f64,
    step: f64,
    collision: f64,
    certainty: i32,
    values: Values,
    stale: bool,
}

impl Curiosity {
    /// Can this mechanism, read from a file, stand for one that began as `fresh`?
    pub fn descends_from(&self, fresh: &Self) -> bool {
        self.planner == fresh.planner
            && (self.goal, self.step, self.collision) == (fresh.goal, fresh.step, fresh.collision)
            && self.certainty == fresh.certainty
            && self.values.are_finite()
    }

    pub fn new(actions: usize, params: &Params, certainty: u32) -> Self {
        Self {
            planner: Planner {
                actions,
                known_after: 1,
                gamma: params.gamma,
            },
            goal: params.goal,
            step: params.step,
            collision: params.collision,
            certainty: certainty as i32,
            values: Values::default(),
            stale: true,
        }
    }

    /// Something was learned that may change the plan.
    pub fn wake(&mut self) {
        self.stale = true;
    }

    /// How promising each action of a percept is.
    pub fn promise(
        &mut self,
        percept: usize,
        memory: &Transitions,
        collisions: &CollisionRules,
        returns: &ReturnRules,
    ) -> PredictionArray {
        if std::mem::take(&mut self.stale) {
            let before = std::mem::take(&mut self.values);
            let back = ways_back(memory, returns);
            let belief = |number: usize, action| {
                if let Some(&to) = back.get(&(number, action)) {
                    let reward = self.step;
                    return Belief::Leads(Believed { reward, to });
                }
                let percept: &Percept = &memory.percepts()[number];
                let bump = collisions.forecast(percept, action).powi(self.certainty);
                Belief::Worth((1.0 - bump) * self.goal + bump * self.collision)
            };
            self.values = self.planner.plan(memory, belief, before);
        }
        let mut array = PredictionArray::new(self.planner.actions);
        for action in Action::all(self.planner.actions) {
            if let Some(value) = self.values.get(percept, action) {
                array.set(action, value);
            }
        }
        array
    }
}

/// By pair: the number of the percept to which a way back is believed to lead.
fn ways_back(memory: &Transitions, returns: &ReturnRules) -> BTreeMap<(usize, Action), usize> {
    let mut ways = BTreeMap::new();
    for &(from, there) in memory.tried() {
        if let Some(to) = memory
            .outcomes(from, there)
            .only_next()
            .filter(|&to| to != from)
        {
            ways.extend(returns.undoing(there).map(|back| ((to, back), from)));
        }
    }
    ways
}
