//! What acts: the rules that the plan teaches, or the plan itself.

use super::Learner;
use crate::agent::recall::context::{Tracker, View};
use crate::agent::recall::course::Course;
use crate::agent::recall::planned::{ChartedPlan, planned_worth};
use xcs::{Action, Classifier, Percept, PredictionArray};

/// The most contexts that are remembered as met when driving.
const MOST_MET: usize = 4096;

/// What acts in episodes in which nothing is looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Decider {
    /// Rules, which the plan teaches.
    Rules,
    /// The plan itself; there are no rules.
    Plan,
}

/// The rules that match what is perceived and remembered now.
#[derive(Debug, Clone, Copy, Default)]
pub struct Matching {
    /// Micro-classifiers in \[M\].
    pub match_set: u32,
    /// Those that advocate the action.
    pub action_set: u32,
    /// The fittest that advocates it.
    pub fittest: Option<Classifier>,
}

impl Learner {
    /// The same whose plan acts.
    pub fn by_plan(self) -> Self {
        let decider = Decider::Plan;
        Self { decider, ..self }
    }

    /// What acts.
    pub fn decider(&self) -> Decider {
        self.decider
    }

    /// What was planned.
    pub fn planned(&self) -> ChartedPlan {
        ChartedPlan::new(self.map.clone(), self.planner.clone())
    }

    /// The number of rules or, if the plan acts, of beliefs that were planned for.
    pub fn size(&self) -> usize {
        match self.decider {
            Decider::Rules => self.rules.len(),
            Decider::Plan => self.planner.beliefs(),
        }
    }

    /// What is made of a percept when an episode begins with it.
    pub fn worth_at_first(&self, percept: &Percept) -> PredictionArray {
        let mut begun = Tracker::default();
        begun.perceive(&self.map, percept);
        self.worth(&begun)
    }

    /// What is made of what is remembered.
    pub(super) fn worth(&self, tracker: &Tracker) -> PredictionArray {
        let (map, actions) = (&self.map, self.actions);
        match self.decider {
            Decider::Rules => self.rules.sums(&tracker.context(map)).array(actions, false),
            Decider::Plan => planned_worth(&self.planner, map, tracker, actions),
        }
    }

    /// Counts the rules that match, and looks for the fittest of those that advocate an action.
    pub fn matching(&self, action: Action) -> Matching {
        let mut found = Matching::default();
        let context = self.tracker.context(&self.map);
        self.rules.for_each_match(&context, |_, rule| {
            found.match_set += rule.numerosity;
            if rule.action == action {
                found.action_set += rule.numerosity;
                let fitter = found.fittest.is_none_or(|best| rule.fitness > best.fitness);
                found.fittest = if fitter { Some(*rule) } else { found.fittest };
            }
        });
        found
    }

    /// Notes what was met when nothing was explored, and in the records of the rules that chose the action whether
    /// it was right; tells whether they are to be corrected: in such a context it mostly was not, or none matched.
    pub(super) fn meet(&mut self, action: Action) -> bool {
        if self.decider == Decider::Plan || self.explores() || self.tracker.belief().is_empty() {
            return false;
        }
        let (belief, pomdp) = (self.tracker.belief(), &self.map.pomdp);
        let course = Course::on(&self.map, View::Steps, &self.xcs);
        let context = self.tracker.context(&self.map);
        let mut costs = self.planner.costs(pomdp, belief);
        if !course.approves(costs.regret(action, pomdp)) {
            // Before an action is held for wrong, all is planned for that may follow.
            costs = self.planner.settled_costs(pomdp, belief);
        }
        let right = course.approves(costs.regret(action, pomdp));
        let acted = self.rules.record(&context, action, right);
        if self.met.len() >= MOST_MET && !self.met.contains_key(&context) {
            return false;
        }
        let met = self.met.entry(context).or_default();
        met.add(&costs, &self.map);
        let wrong = !course.approves(met.regret(action, self.actions));
        course.counts(met) && (wrong || !acted)
    }

    /// Plans on where moves are exact, until nothing changes any more, as is done for what rules learn from.
    pub(super) fn settle(&mut self) {
        let (pomdp, planner) = (&self.map.pomdp, &mut self.planner);
        for start in 0..self.map.starts() {
            planner.settled_costs(pomdp, &self.map.first_belief(start));
        }
    }
}
