//! `xcscr-plus`: XCSCR plus a learned model of the world.
//!
//! The classifier system and its four mechanisms are those of `xcscr` ([`Combined`]). The model adds two parts:
//! * **Planned exploration**: while an untried action may be better than all known ones, the planner leads there. It
//!   never chooses an action that exploits; the rules do.
//! * **Repair**: where experience contradicts the rules, and at the end of an episode wherever the robot was, rules that
//!   choose a worse action than the plan are corrected by guided covering.
//!
//! Real rewards, \[R\] and the four mechanisms work as in `xcscr`. In a world that does not change they are redundant: the
//! model contains all that they could say.
//!
//! `r-max` is the same model with its plan as the policy.

mod params;
mod r_max;
mod repair;
mod world_model;

pub use params::PlusParams;
pub use r_max::RMax;
pub use repair::Repair;
pub use world_model::WorldModel;

use crate::agent::credit::Combined;
use crate::agent::explorer::Explorer;
use crate::agent::knowledge::Knowledge;
use crate::agent::{Agent, Choice, DecisionSource, EndCredit, RuleUpdates, StepCredit, Transition};
use xcs::{Action, Percept, PredictionArray};

/// The method `xcscr-plus`.
#[derive(Debug, Clone)]
pub struct XcscrPlus {
    credit: Combined,
    model: WorldModel,
    /// `None` if the rules are not repaired.
    repair: Option<Repair>,
    /// The next step of exploration; `None` if the rules decide.
    heading: Option<Action>,
}

impl XcscrPlus {
    /// Creates an untrained learner.
    pub fn new(credit: Combined, model: WorldModel, repair: Option<Repair>) -> Self {
        Self {
            credit,
            model,
            repair,
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
        let Some(repair) = &mut self.repair else {
            return credit;
        };
        let here = self.model.number_of(step.percept);
        let contradicted = here.is_some_and(|number| repair.is_contradicted(step, number));
        if contradicted && self.heading.is_none() {
            repair.learn(self.model.examples());
            let next = step.next.and_then(|next| self.model.number_of(next));
            repair.correct(self.credit.xcs_mut(), here.into_iter().chain(next));
        }
        credit
    }

    fn end_episode(&mut self, reached_goal: bool) -> EndCredit {
        let end = self.credit.end_episode(reached_goal);
        self.model.end_episode();
        if let Some(repair) = &mut self.repair {
            repair.learn(self.model.examples());
            repair.end_episode(self.credit.xcs_mut(), reached_goal);
        }
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

    fn rule_updates(&self) -> RuleUpdates {
        let all = self.credit.rule_updates().experience;
        let model = self.repair.as_ref().map_or(0, Repair::updates);
        RuleUpdates {
            experience: all.saturating_sub(model),
            model,
        }
    }
}
