//! `r-max`: the model of `xcscr-plus` with its plan as the policy (Brafman and Tennenholtz 2002).

use crate::agent::explorer::Explorer;
use crate::agent::knowledge::Knowledge;
use crate::agent::plus::WorldModel;
use crate::agent::{Agent, Choice, DecisionSource, EndCredit, Params, StepCredit, Transition};
use xcs::{Action, Percept, PredictionArray};

/// The method `r-max`.
#[derive(Debug, Clone)]
pub struct RMax {
    model: WorldModel,
    params: Params,
    heading: Option<Action>,
}

impl RMax {
    /// Creates an untrained learner. The parameters must be those of the model.
    pub fn new(model: WorldModel, params: Params) -> Self {
        Self {
            model,
            params,
            heading: None,
        }
    }
}

impl Agent for RMax {
    fn begin_episode(&mut self, _: bool) {
        self.model.begin_episode();
    }

    fn observe(&mut self, percept: &Percept) -> PredictionArray {
        self.heading = self.model.explore(percept);
        self.model.values(percept)
    }

    fn choose(&mut self, _: &Percept, values: &PredictionArray, explorer: &mut Explorer) -> Choice {
        if let Some(action) = self.heading {
            return Choice::new(action, DecisionSource::Planner);
        }
        let (action, explores) = match self.model.plans_exploration() {
            true => (explorer.exploit(values), false),
            false => explorer.choose(values),
        };
        let by_chance = explores || values.greatest().is_none();
        Choice::by(DecisionSource::Table, action, by_chance)
    }

    fn update(&mut self, step: &Transition<'_>) -> StepCredit {
        self.model.learn(step);
        StepCredit {
            short_term_reward: self.params.short_term(step.outcome),
            ..StepCredit::default()
        }
    }

    fn end_episode(&mut self, reached_goal: bool) -> EndCredit {
        self.model.end_episode();
        let long_term_reward = if reached_goal { self.params.goal } else { 0.0 };
        EndCredit::new(long_term_reward, 1.0)
    }

    fn step_threshold(&self) -> u32 {
        self.params.step_threshold
    }

    fn values(&self, percept: &Percept) -> PredictionArray {
        self.model.values(percept)
    }

    fn knowledge(&self) -> Knowledge {
        Knowledge::Table(self.model.table())
    }

    fn warm_start(&mut self, knowledge: &Knowledge) -> bool {
        self.model.warm_start(knowledge)
    }

    fn rule_count(&self) -> usize {
        self.model.pair_count()
    }
}
