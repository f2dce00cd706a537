//! A learner whose state is the percept: a transition model, a plan on it, and a policy.
//!
//! The policy chooses every action that exploits: in training, in evaluations and in exports. The model
//! acts only while something is left to explore. It has two uses:
//! * Its plan labels percepts with their best actions ([`PlannedValues`]). Rules are distilled from these
//!   examples ([`RulePolicy`]), or the plan itself is the policy ([`PolicyKind::Plan`]).
//! * It guides exploration to actions that may be better than all known ones ([`Exploration`]). It also
//!   predicts collisions and inverse actions, so that these need not be tried everywhere.
//!
//! The study `repairs` switches off each part in turn.

use std::collections::BTreeMap;

use crate::agent::knowledge::Knowledge;
use crate::agent::model::Generalisation;
use crate::agent::model::collision_rules::CollisionRules;
use crate::agent::model::transitions::{Transition, Transitions};
use crate::agent::planner::exploration::{Exploration, Inputs};
use crate::agent::planner::sweeping::PlannedValues;
use crate::agent::policy::explorer::Explorer;
use crate::agent::policy::{PolicyKind, RulePolicy};
use crate::agent::{Agent, Choice, DecisionSource, EndCredit, Params, PlusParams, StepCredit};
use xcs::random::Stream;
use xcs::{Action, Layout, Percept, PredictionArray, Xcs};
use xcscr_robot::arena::Outcome;

/// Inputs, plan and policy over percepts.
#[derive(Debug, Clone)]
pub struct PerceptLearner {
    actions: usize,
    params: Params,
    own: PlusParams,
    model: Transitions,
    known: PlannedValues,
    /// The rules that choose; `None` if the plan does.
    rules: Option<RulePolicy>,
    collisions: CollisionRules,
    exploration: Exploration,
    /// Breaks ties between equally good paths.
    stream: Stream,
    /// The steps of this episode.
    path: Vec<Taken>,
    /// The current percept and its number.
    present: Option<(Percept, usize)>,
    /// The next step of exploration; `None` if the policy decides.
    heading: Option<Action>,
}

/// A step of the episode.
#[derive(Debug, Clone, Copy)]
struct Taken {
    /// The step, without the next percept.
    step: Transition,
    /// True if the robot bumped. Then the next percept is known at once.
    bumped: bool,
}

impl PerceptLearner {
    /// Creates an untrained learner around an empty classifier system. The first `ring` bits of its
    /// percepts form a ring around the robot; `layout` lists their numbers. `planning` breaks ties between equally good paths. The
    /// parameters must have been checked.
    pub fn new(
        xcs: Xcs,
        (ring, layout): (usize, Layout),
        params: Params,
        own: PlusParams,
        (policy, planning): (PolicyKind, Stream),
    ) -> Self {
        let actions = xcs.actions();
        let ring = if own.turned_rules { ring } else { 0 };
        let known = PlannedValues::new(actions, &params);
        Self {
            actions,
            model: Transitions::default(),
            rules: (policy == PolicyKind::Rules).then(|| RulePolicy::new(xcs, layout.clone())),
            collisions: CollisionRules::new(actions, ring, layout, own.certainty),
            exploration: Exploration::new(actions, &params, known.floor()),
            known,
            stream: planning,
            path: Vec::new(),
            present: None,
            heading: None,
            params,
            own,
        }
    }

    /// Returns the percept of the last [`observe`](Agent::observe).
    pub fn percept(&self) -> Percept {
        self.present.expect("`observe` comes first").0
    }

    /// Returns true if moves slip, and a percept and action had more results than slips explain.
    pub fn is_refuted(&self) -> bool {
        self.model.is_refuted()
    }

    /// Returns true if fewer than `steps` different percepts were met and no moves slip.
    pub fn has_met_fewer_than(&self, steps: usize) -> bool {
        self.model.percepts().len() < steps && !self.model.slips().any()
    }

    /// Returns the planned action values in a percept; none if no path to a goal is known.
    fn planned(&self, number: usize) -> PredictionArray {
        let mut array = PredictionArray::new(self.actions);
        for (action, value) in self.known.action_values(&self.model, number) {
            array.set(action, value);
        }
        array
    }

    /// Returns the planned action values of all percepts with a known path to a goal.
    fn table(&self) -> BTreeMap<Percept, Vec<Option<f64>>> {
        let row = |number| {
            let values = self.planned(number);
            let row = Action::all(self.actions).map(|action| values.get(action));
            values.greatest().map(|_| row.collect())
        };
        let rows = self.model.sorted();
        rows.filter_map(|(percept, number)| Some((*percept, row(number)?)))
            .collect()
    }

    /// Learns from the last step, given the next percept.
    fn learn_last_step(&mut self, next: Option<Percept>) {
        let Some(&Taken { step, bumped }) = self.path.last() else {
            return;
        };
        self.learn_return(next);
        let (step, action) = (Transition { next, ..step }, step.action);
        let number = self.model.meet(&step.percept);
        let known = self.model.is_known(number, action);
        if self.model.learn(&step, self.model.slips().lead()) {
            let next = next.map(|next| self.model.meet(&next));
            self.known.learn(&self.model, (number, action), next);
        }
        if self.model.is_known(number, action) != known {
            self.exploration.invalidate();
        } else if let Some(next) =
            next.filter(|_| !bumped && self.known.is_best(&self.model, number, action))
        {
            let next = self.model.meet(&next);
            if !self.model.slipped(number, action, next) {
                self.exploration.follow(number, next);
            }
        }
    }

    /// Updates the slip estimate. If it has changed, re-evaluates everything.
    fn update_slips(&mut self) {
        if self.model.update_slips(self.params.step) {
            let slips = self.model.slips();
            self.known.reconsider(&self.model);
            let margin = if slips.any() { slips.lead() } else { 0 };
            self.collisions.set_margin(margin);
            self.exploration.invalidate();
        }
    }

    /// Learns whether the last two steps led there and back.
    fn learn_return(&mut self, next: Option<Percept>) {
        let [.., first, second] = self.path[..] else {
            return;
        };
        let start = first.step.percept;
        if self.own.return_rules && start != second.step.percept && !second.bumped {
            let back = next == Some(start);
            let turn = [first.step.action, second.step.action];
            if self.known.learn_return(&self.model, turn, back) {
                self.exploration.invalidate();
            }
        }
    }

    /// Corrects the rules by the changes of the plan.
    fn distil(&mut self) {
        let examples = self.known.news(&self.model);
        if let Some(rules) = &mut self.rules {
            rules.distil(examples);
        }
    }

    /// Returns the next step of exploration; `None` if no action has an optimistic value above the known values.
    fn explore(&mut self, number: usize) -> Option<Action> {
        let inputs = Inputs {
            model: &self.model,
            known: &self.known,
            collisions: &self.collisions,
        };
        match self.own.planned_exploration {
            true => self.exploration.next(number, &inputs, &mut self.stream),
            false => None,
        }
    }
}

impl Agent for PerceptLearner {
    fn begin_episode(&mut self, _: bool) {
        self.exploration.begin();
    }

    /// Learns from the last step, decides whether to explore, and returns the policy's action values.
    fn observe(&mut self, percept: &Percept) -> PredictionArray {
        let met = self.model.percepts().len();
        let number = self.model.meet(percept);
        if number == met {
            self.exploration.invalidate();
        }
        self.learn_last_step(Some(*percept));
        self.present = Some((*percept, number));
        self.heading = self.explore(number);
        if self.heading.is_none() {
            self.distil();
        }
        match &mut self.rules {
            Some(rules) => rules.predict(percept),
            None => self.planned(number),
        }
    }

    /// Chooses the next step of exploration. If nothing is left to explore, chooses one of the policy's
    /// best actions, or any action if the policy has no values.
    fn choose(&mut self, values: &PredictionArray, explorer: &mut Explorer) -> Choice {
        if let Some(action) = self.heading {
            return Choice::new(action, DecisionSource::Planner);
        }
        let (action, by_chance) = match self.own.planned_exploration {
            true => (explorer.exploit(values), false),
            false => explorer.choose(values),
        };
        let by_chance = by_chance || values.greatest().is_none();
        let source = match self.rules {
            Some(_) => DecisionSource::Rules,
            None => DecisionSource::Table,
        };
        Choice::by(source, action, by_chance)
    }

    fn update(&mut self, action: Action, outcome: Outcome) -> StepCredit {
        let (percept, _) = self.present.expect("`observe` comes before `update`");
        let reward = self.params.short_term(outcome);
        let credit = match &self.rules {
            Some(rules) => rules.credit(action, reward),
            None => StepCredit {
                short_term_reward: reward,
                ..StepCredit::default()
            },
        };
        let bumped = matches!(outcome, Outcome::Collided { .. });
        if self.own.collision_rules && self.collisions.learn(&percept, action, bumped) {
            self.exploration.invalidate();
        }
        let step = Transition {
            percept,
            action,
            reward,
            next: None,
        };
        self.path.push(Taken { step, bumped });
        credit
    }

    fn end_episode(&mut self, reached_goal: bool) -> EndCredit {
        let long_term_reward = if reached_goal { self.params.goal } else { 0.0 };
        if let Some(last) = self.path.last_mut() {
            last.step.reward += long_term_reward;
            let Taken { step, bumped } = *last;
            if reached_goal {
                self.learn_last_step(None);
            } else if bumped {
                self.learn_last_step(Some(step.percept));
            }
        }
        self.path.clear();
        self.update_slips();
        self.exploration.begin();
        self.known.tidy();
        self.distil();
        EndCredit::new(long_term_reward, 1.0)
    }

    fn step_threshold(&self) -> u32 {
        self.params.step_threshold
    }

    fn values(&self, percept: &Percept) -> PredictionArray {
        match (&self.rules, self.model.number_of(percept)) {
            (Some(rules), _) => rules.xcs().values(percept),
            (None, Some(number)) => self.planned(number),
            (None, None) => PredictionArray::new(self.actions),
        }
    }

    fn knowledge(&self) -> Knowledge {
        let Some(rules) = &self.rules else {
            return Knowledge::Table(self.table());
        };
        Knowledge::PerceptRules {
            rules: rules.xcs().population().clone(),
            generalisation: Generalisation {
                collisions: self.collisions.rules(),
                returns: self.known.returns().rules().collect(),
            },
        }
    }

    /// Starts from the predictions of another world. Its best actions are not transferred, because they
    /// depend on the maze.
    fn warm_start(&mut self, knowledge: &Knowledge) -> bool {
        let Some(generalisation) = knowledge.generalisation() else {
            return false;
        };
        if self.own.collision_rules {
            self.collisions.warm_start(&generalisation.collisions);
        }
        if self.own.return_rules {
            self.known.warm_start(&generalisation.returns);
        }
        true
    }

    /// Returns the number of rules, or of planned pairs of percept and action.
    fn rule_count(&self) -> usize {
        match &self.rules {
            Some(rules) => rules.xcs().population().len(),
            None => self.model.percepts().len() * self.actions,
        }
    }
}
