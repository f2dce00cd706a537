//! Rules that match contexts on a map, distilled from the plan.

use serde::{Deserialize, Serialize};

use crate::agent::StepCredit;
use crate::agent::credit::credit_of_rules;
use crate::agent::estimator::map::Map;
use crate::agent::estimator::map::tracker::{Tracker, View};
use crate::agent::planner::rtdp_bel::BeliefPlanner;
use crate::agent::policy::distillation::Distillation;
use crate::agent::policy::examples::Examples;
use xcs::random::Stream;
use xcs::{Action, Percept, Population, PredictionArray};

/// The maximum number of contexts stored while driving.
const MOST_MET: usize = 4096;
/// The share of its steps that a rule set may lose to observation errors without a wider view.
const TOLERATED: f64 = 0.03;

/// The rules, and the contexts that they are corrected by.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct MapRules {
    rules: Population,
    /// The contexts met without exploration since the last change of the maps or, with exact moves, the
    /// plan.
    met: Examples,
}

impl MapRules {
    /// Starts from the rules of another world.
    pub fn start_from(rules: &Population) -> Self {
        let (rules, met) = (rules.without_records(), Examples::new());
        Self { rules, met }
    }

    /// Returns the rules.
    pub fn rules(&self) -> &Population {
        &self.rules
    }

    /// Discards the stored contexts.
    pub fn forget_contexts(&mut self) {
        self.met.clear();
    }

    /// Returns the value of each action in a context.
    pub fn values(&self, context: &Percept, actions: usize) -> PredictionArray {
        self.rules.sums(context).array(actions, false)
    }

    /// Describes the rules that match a context, without their error.
    pub fn credit(&self, context: &Percept, action: Action) -> StepCredit {
        StepCredit {
            error: 0.0,
            ..credit_of_rules(&self.rules, context, action)
        }
    }

    /// Stores the context of a step without exploration, and records in the rules that chose the action
    /// whether it was right. Returns true if the rules need correction: the action was mostly wrong in
    /// this context, or no rule matched.
    pub fn meet(
        &mut self,
        (map, tracker): (&Map, &Tracker),
        action: Action,
        planner: &mut BeliefPlanner,
        params: &xcs::Params,
    ) -> bool {
        let (belief, pomdp) = (tracker.belief(), &map.pomdp);
        if belief.is_empty() {
            return false;
        }
        let distillation = Distillation::on(map, View::Steps, params);
        let context = tracker.context(map);
        let mut costs = planner.costs(pomdp, belief);
        if !distillation.approves(costs.regret(action, pomdp)) {
            // Before an action counts as wrong, everything that may follow is planned for.
            costs = planner.settled_costs(pomdp, belief);
        }
        let right = distillation.approves(costs.regret(action, pomdp));
        let acted = self.rules.record(&context, action, right);
        if !self.met.contains_key(&context) {
            make_room(&mut self.met, MOST_MET);
        }
        let met = self.met.entry(context).or_default();
        met.add(&costs, map);
        let wrong = !distillation.approves(met.regret(action, pomdp.actions()));
        distillation.counts(met) && (wrong || !acted)
    }

    /// Corrects the rules by the plan and by the stored contexts. With observation errors, the last steps
    /// may differ from those of all simulated episodes. So rules match them only if they lose too much
    /// otherwise.
    pub fn distil(
        &mut self,
        map: &Map,
        planner: &mut BeliefPlanner,
        params: &xcs::Params,
        stream: &mut Stream,
    ) {
        let before = std::mem::take(&mut self.rules);
        // All rollouts draw the same random numbers, which learning does not use.
        let rollout_stream = stream.clone();
        let mut least_regret = f64::INFINITY;
        for &view in View::fit_for(map) {
            let distillation = Distillation::on(map, view, params);
            let mut rules = before.clone();
            distillation.correct(&mut rules, &self.met, planner, stream);
            let regret = distillation.mean_regret(&rules, planner, &mut rollout_stream.clone());
            if regret < least_regret {
                (self.rules, least_regret) = (rules, regret);
            }
            if regret <= TOLERATED {
                return;
            }
        }
    }
}

/// Removes the rarest context, the first one of several, if the maximum number is reached.
fn make_room(met: &mut Examples, most: usize) {
    if met.len() < most {
        return;
    }
    let rarest = met.iter().min_by(|a, b| a.1.weight.total_cmp(&b.1.weight));
    if let Some(context) = rarest.map(|(context, _)| *context) {
        met.remove(&context);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::agent::policy::examples::Example;

    #[test]
    fn a_new_context_takes_the_place_of_the_rarest_one() {
        let context = |word| Percept::from_word(word, 8);
        let example = |weight| {
            let mut example = Example::default();
            example.weight = weight;
            example
        };
        let mut met: Examples = [(1, 3.0), (2, 1.0), (3, 1.0)]
            .map(|(word, weight)| (context(word), example(weight)))
            .into();
        make_room(&mut met, 4);
        assert_eq!(met.len(), 3, "control: there is room");
        make_room(&mut met, 3);
        assert!(met.len() == 2 && !met.contains_key(&context(2)));
    }
}
