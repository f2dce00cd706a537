//! The policy of a learner with a map: rules distilled from the plan, or the plan itself.

use super::{MapLearner, TOLERATED};
use crate::agent::StepCredit;
use crate::agent::credit::credit_of_rules;
use crate::agent::estimator::map::tracker::{Tracker, View};
use crate::agent::policy::PolicyKind;
use crate::agent::policy::distillation::Distillation;
use crate::agent::policy::examples::Examples;
use crate::agent::policy::plan::planned_values;
use xcs::{Action, PredictionArray};

/// The maximum number of contexts stored while driving.
const MOST_MET: usize = 4096;

impl MapLearner {
    /// Returns the policy's action values for a belief and the latest steps.
    pub(super) fn values_of(&self, tracker: &Tracker) -> PredictionArray {
        let (map, actions) = (&self.map, self.actions);
        match self.policy {
            PolicyKind::Rules => {
                let sums = self.learned.rules.sums(&tracker.context(map));
                sums.array(actions, false)
            }
            PolicyKind::Plan => planned_values(&self.learned.planner, map, tracker, actions),
        }
    }

    /// Describes the rules that match now, without their error.
    pub(super) fn matching(&self, action: Action) -> StepCredit {
        let context = self.tracker.context(&self.map);
        StepCredit {
            error: 0.0,
            ..credit_of_rules(&self.learned.rules, &context, action)
        }
    }

    /// Stores the context of a step without exploration, and records in the rules that chose the action
    /// whether it was right. Returns true if the rules need correction: the action was mostly wrong in
    /// this context, or no rule matched.
    pub(super) fn meet(&mut self, action: Action) -> bool {
        if self.policy == PolicyKind::Plan || self.explores() || self.tracker.belief().is_empty() {
            return false;
        }
        let (belief, pomdp) = (self.tracker.belief(), &self.map.pomdp);
        let distillation = Distillation::on(&self.map, View::Steps, &self.xcs);
        let context = self.tracker.context(&self.map);
        let learned = &mut self.learned;
        let mut costs = learned.planner.costs(pomdp, belief);
        if !distillation.approves(costs.regret(action, pomdp)) {
            // Before an action counts as wrong, everything that may follow is planned for.
            costs = learned.planner.settled_costs(pomdp, belief);
        }
        let right = distillation.approves(costs.regret(action, pomdp));
        let acted = learned.rules.record(&context, action, right);
        if !learned.met.contains_key(&context) {
            make_room(&mut learned.met, MOST_MET);
        }
        let met = learned.met.entry(context).or_default();
        met.add(&costs, &self.map);
        let wrong = !distillation.approves(met.regret(action, self.actions));
        distillation.counts(met) && (wrong || !acted)
    }

    /// Corrects the rules by the plan and by the stored contexts. With observation errors, the last steps
    /// may differ from those of all simulated episodes. So rules match them only if they lose too much
    /// otherwise.
    pub(super) fn distil(&mut self) {
        let learned = &mut self.learned;
        let before = std::mem::take(&mut learned.rules);
        // All rollouts draw the same random numbers, which learning does not use.
        let rollout_stream = learned.stream.clone();
        let mut least_regret = f64::INFINITY;
        for &view in View::fit_for(&self.map) {
            let distillation = Distillation::on(&self.map, view, &self.xcs);
            let mut rules = before.clone();
            let (planner, stream) = (&mut learned.planner, &mut learned.stream);
            distillation.correct(&mut rules, &learned.met, planner, stream);
            let regret = distillation.mean_regret(&rules, planner, &mut rollout_stream.clone());
            if regret < least_regret {
                (learned.rules, least_regret) = (rules, regret);
            }
            if regret <= TOLERATED {
                return;
            }
        }
    }

    /// Plans until nothing changes any more if moves are exact, as for the examples of rules.
    pub(super) fn settle(&mut self) {
        let (pomdp, planner) = (&self.map.pomdp, &mut self.learned.planner);
        for start in 0..self.map.starts() {
            planner.settled_costs(pomdp, &self.map.first_belief(start));
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
    use xcs::Percept;

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
