//! A learned model of the world: what follows an action, a plan on it, and what is left to explore.

use std::collections::BTreeMap;

use crate::agent::knowledge::Knowledge;
use crate::agent::model::Generalisation;
use crate::agent::model::collision_rules::CollisionRules;
use crate::agent::model::transitions::{Experience, Transitions};
use crate::agent::planner::exploration::{Exploration, Inputs};
use crate::agent::planner::sweeping::PlannedValues;
use crate::agent::{Params, PlusParams, Transition};
use xcs::random::Stream;
use xcs::{Action, LabelledExample, Layout, Percept, PredictionArray};
use xcscr_robot::arena::Outcome;

/// Counted transitions, rules that generalise them, a plan, and planned exploration.
#[derive(Debug, Clone)]
pub struct WorldModel {
    actions: usize,
    params: Params,
    own: PlusParams,
    transitions: Transitions,
    plan: PlannedValues,
    collisions: CollisionRules,
    exploration: Exploration,
    /// Breaks ties between equally good paths.
    stream: Stream,
    /// The last step of this episode.
    last: Option<Experience>,
}

impl WorldModel {
    /// Creates an untrained model for `actions` actions. The first `ring` bits of a percept form a ring around the
    /// robot; `layout` lists its numbers. The parameters must have been checked.
    pub fn new(
        actions: usize,
        ring: usize,
        layout: Layout,
        params: Params,
        own: PlusParams,
        stream: Stream,
    ) -> Self {
        let ring = if own.turned_rules { ring } else { 0 };
        let plan = PlannedValues::new(actions, &params);
        Self {
            actions,
            transitions: Transitions::default(),
            collisions: CollisionRules::new(actions, ring, layout),
            exploration: Exploration::new(actions, &params, plan.floor()),
            plan,
            stream,
            last: None,
            params,
            own,
        }
    }

    /// Returns true if exploration is planned.
    pub fn plans_exploration(&self) -> bool {
        self.own.planned_exploration
    }

    /// Begins an episode.
    pub fn begin_episode(&mut self) {
        self.exploration.begin();
        self.last = None;
    }

    /// Learns from a step.
    pub fn learn(&mut self, step: &Transition<'_>) {
        let Transition {
            percept,
            action,
            outcome,
            next,
            ..
        } = *step;
        let bumped = matches!(outcome, Outcome::Collided { .. });
        if self.own.collision_rules && self.collisions.learn(percept, action, bumped) {
            self.exploration.invalidate();
        }
        let is_goal = outcome == Outcome::ReachedGoal;
        let step = Experience {
            percept: *percept,
            action,
            reward: self.params.short_term(outcome) + if is_goal { self.params.goal } else { 0.0 },
            next: next.copied().filter(|_| !is_goal),
        };
        self.learn_return(&step, bumped);
        self.learn_transition(&step, bumped);
        self.last = Some(step);
    }

    /// Learns whether the last two steps led there and back.
    fn learn_return(&mut self, second: &Experience, bumped: bool) {
        let Some(first) = self.last.filter(|_| self.own.return_rules && !bumped) else {
            return;
        };
        if first.percept != second.percept {
            let back = second.next == Some(first.percept);
            let turn = [first.action, second.action];
            if self.plan.learn_return(&self.transitions, turn, back) {
                self.exploration.invalidate();
            }
        }
    }

    /// Counts a transition, and updates the plan.
    fn learn_transition(&mut self, step: &Experience, bumped: bool) {
        let (number, action) = (self.meet(&step.percept), step.action);
        let known = self.transitions.is_known(number, action);
        let next = step.next.map(|next| self.meet(&next));
        let lead = self.transitions.slips().lead();
        if self.transitions.learn(step, lead) {
            self.plan.learn(&self.transitions, (number, action), next);
        }
        if self.transitions.is_known(number, action) != known {
            self.exploration.invalidate();
        } else if let Some(next) = next.filter(|_| !bumped)
            && self.plan.is_best(&self.transitions, number, action)
            && !self.transitions.slipped(number, action, next)
        {
            self.exploration.follow(number, next);
        }
    }

    /// Returns the number of a percept, and adds the percept if it is new.
    fn meet(&mut self, percept: &Percept) -> usize {
        let met = self.transitions.percepts().len();
        let number = self.transitions.meet(percept);
        if number == met {
            self.exploration.invalidate();
        }
        number
    }

    /// Ends an episode: updates the estimate of slips. If it has changed, evaluates everything again.
    pub fn end_episode(&mut self) {
        if self.transitions.update_slips(self.params.step) {
            let slips = self.transitions.slips();
            self.plan.reconsider(&self.transitions);
            let margin = if slips.any() { slips.lead() } else { 0 };
            self.collisions.set_margin(margin);
            self.exploration.invalidate();
        }
        self.exploration.begin();
        self.plan.tidy();
    }

    /// Returns the next step of exploration in a percept; `None` if no action has an optimistic value above the known
    /// values.
    pub fn explore(&mut self, percept: &Percept) -> Option<Action> {
        let number = self.meet(percept);
        let inputs = Inputs {
            model: &self.transitions,
            known: &self.plan,
            collisions: &self.collisions,
        };
        match self.own.planned_exploration {
            true => self.exploration.next(number, &inputs, &mut self.stream),
            false => None,
        }
    }

    /// Returns the number of a percept; `None` if it was never met.
    pub fn number_of(&self, percept: &Percept) -> Option<usize> {
        self.transitions.number_of(percept)
    }

    /// Returns the percepts whose best actions may have changed since the last call, by number.
    pub fn examples(&mut self) -> Vec<(usize, LabelledExample)> {
        self.plan.news(&self.transitions)
    }

    /// Returns the planned action values in a percept; empty if no path to a goal is known.
    pub fn values(&self, percept: &Percept) -> PredictionArray {
        let number = self.transitions.number_of(percept);
        number.map_or(PredictionArray::new(self.actions), |number| {
            self.planned(number)
        })
    }

    fn planned(&self, number: usize) -> PredictionArray {
        let mut array = PredictionArray::new(self.actions);
        for (action, value) in self.plan.action_values(&self.transitions, number) {
            array.set(action, value);
        }
        array
    }

    /// Returns the planned action values of all percepts with a known path to a goal.
    pub fn table(&self) -> BTreeMap<Percept, Vec<Option<f64>>> {
        let row = |number| {
            let values = self.planned(number);
            let row = Action::all(self.actions).map(|action| values.get(action));
            values.greatest().map(|_| row.collect())
        };
        let rows = self.transitions.sorted();
        rows.filter_map(|(percept, number)| Some((*percept, row(number)?)))
            .collect()
    }

    /// Returns the percepts with a known path to a goal, sorted.
    pub fn known(&self) -> Vec<Percept> {
        let known = |&(_, number): &(&Percept, usize)| self.plan.value(number) > 0.0;
        let known = self.transitions.sorted().filter(known);
        known.map(|(percept, _)| *percept).collect()
    }

    /// Returns the number of pairs of a percept that was met and an action.
    pub fn pair_count(&self) -> usize {
        self.transitions.percepts().len() * self.actions
    }

    /// Returns the rules that predict transitions.
    pub fn generalisation(&self) -> Generalisation {
        Generalisation {
            collisions: self.collisions.rules(),
            returns: self.plan.returns().rules().collect(),
        }
    }

    /// Starts from the rules that predict transitions in another world; `false` if there are none.
    pub fn warm_start(&mut self, knowledge: &Knowledge) -> bool {
        let Some(known) = knowledge.generalisation() else {
            return false;
        };
        if self.own.collision_rules {
            self.collisions.warm_start(&known.collisions);
        }
        if self.own.return_rules {
            self.plan.warm_start(&known.returns);
        }
        true
    }
}
