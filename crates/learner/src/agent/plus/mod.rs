//! `xcscr-plus`: XCSCR plus a learned model of the world.
//!
//! The classifier system and its four mechanisms are those of `xcscr` ([`Combined`]). The model adds three parts:
//! * **Planned exploration**: while an untried action may be better than all known ones, the planner leads there. It
//!   never chooses an action that exploits; the rules do.
//! * **Replay**: imprinting (Alg. 4) with the plan in place of \[PS\]. After each step, known percepts are replayed with
//!   the reward of a success for the best actions, and that of a failure for all others.
//! * **Guided covering**: a percept that the rules still decide wrongly at the end of an episode gets the most general
//!   rules that no known percept contradicts.
//!
//! `r-max` is the same model with its plan as the policy.

mod environment;
mod params;
mod r_max;
mod replay;
mod world_model;

pub use environment::{EnvironmentLearner, EnvironmentParams};
pub use params::PlusParams;
pub use r_max::RMax;
pub use replay::{Replay, ReplayParams};
pub use world_model::WorldModel;

use crate::agent::credit::Combined;
use crate::agent::explorer::Explorer;
use crate::agent::knowledge::Knowledge;
use crate::agent::{Agent, Choice, DecisionSource, EndCredit, StepCredit, Transition};
use xcs::{Action, Percept, PredictionArray};

/// The method `xcscr-plus`.
#[derive(Debug, Clone)]
pub struct XcscrPlus {
    credit: Combined,
    model: WorldModel,
    replay: Replay,
    /// The next step of exploration; `None` if the rules decide.
    heading: Option<Action>,
}

impl XcscrPlus {
    /// Creates an untrained learner.
    pub fn new(credit: Combined, model: WorldModel, replay: Replay) -> Self {
        Self {
            credit,
            model,
            replay,
            heading: None,
        }
    }
}

impl Agent for XcscrPlus {
    fn begin_episode(&mut self, evolves: bool) {
        self.credit.begin_episode(evolves);
        self.model.begin_episode();
    }

    /// Forms \[M\], and decides whether to explore.
    fn observe(&mut self, percept: &Percept) -> PredictionArray {
        self.heading = self.model.explore(percept);
        self.credit.observe(percept)
    }

    /// Chooses the next step of exploration. If nothing is left to explore, the rules choose.
    fn choose(
        &mut self,
        percept: &Percept,
        values: &PredictionArray,
        explorer: &mut Explorer,
    ) -> Choice {
        match self.heading {
            Some(action) => Choice::new(action, DecisionSource::Planner),
            None if self.model.plans_exploration() => {
                Choice::new(explorer.exploit(values), DecisionSource::Rules)
            }
            None => self.credit.choose(percept, values, explorer),
        }
    }

    fn update(&mut self, step: &Transition<'_>) -> StepCredit {
        let credit = self.credit.update(step);
        self.model.learn(step);
        self.replay.learn(self.model.examples());
        self.replay.after_step(self.credit.xcs_mut(), step.next);
        credit
    }

    fn end_episode(&mut self, reached_goal: bool) -> EndCredit {
        let end = self.credit.end_episode(reached_goal);
        self.model.end_episode();
        self.replay.learn(self.model.examples());
        self.replay.after_episode(self.credit.xcs_mut());
        end
    }

    fn step_threshold(&self) -> u32 {
        self.credit.step_threshold()
    }

    fn values(&self, percept: &Percept) -> PredictionArray {
        self.credit.values(percept)
    }

    fn knowledge(&self) -> Knowledge {
        Knowledge::PerceptRules {
            rules: self.credit.rules().clone(),
            generalisation: self.model.generalisation(),
            known: self.model.known(),
        }
    }

    /// Starts from the rules that predict transitions in another world. Its best actions are not transferred, because
    /// they depend on the maze.
    fn warm_start(&mut self, knowledge: &Knowledge) -> bool {
        self.model.warm_start(knowledge)
    }

    fn rule_count(&self) -> usize {
        self.credit.rule_count()
    }
}
