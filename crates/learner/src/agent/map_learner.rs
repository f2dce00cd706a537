//! A learner whose state is a cell of a map that it draws itself: percepts that several cells share are told apart
//! by where the robot has come from.

use super::explorer::Explorer;
use super::knowledge::Knowledge;
use super::memory::{self, MemoryError};
use super::policy::PolicyKind;
use super::recall::learner::{Decider, Learner};
use super::recall::{Map, MemoryParams, Vision, Worth};
use super::{Choice, Chooser, EndCredit, Params, StepCredit};
use xcs::random::Stream;
use xcs::{Action, Percept, Population, PredictionArray};
use xcscr_robot::arena::Outcome;

/// Maps, a plan over beliefs about the own cell, and a policy.
#[derive(Debug, Clone)]
pub struct MapLearner {
    learner: Learner,
    params: Params,
    /// What is perceived now.
    percept: Option<Percept>,
}

impl MapLearner {
    /// Creates an untrained learner for a number of actions and a way of seeing; `stream` draws simulated episodes and
    /// ties of exploration. The parameters must have been checked.
    pub fn new(
        body: (usize, Vision),
        xcs: xcs::Params,
        params: Params,
        own: MemoryParams,
        (policy, stream): (PolicyKind, Stream),
    ) -> Self {
        let Params {
            goal, step, gamma, ..
        } = params;
        let worth = Worth { goal, step, gamma };
        let learner = Learner::new(body, xcs, worth, own, stream);
        Self {
            learner: match policy {
                PolicyKind::Rules => learner,
                PolicyKind::Plan => learner.by_plan(),
            },
            params,
            percept: None,
        }
    }

    /// Updates the belief about the own cell, and returns the policy's action values.
    pub fn observe(&mut self, percept: &Percept) -> PredictionArray {
        self.percept = Some(*percept);
        self.learner.perceive(percept)
    }

    /// Explores in whole episodes, which get rarer, and where the policy says nothing; else the policy chooses.
    pub fn choose(&mut self, worth: &PredictionArray, explorer: &mut Explorer) -> Choice {
        if self.learner.explores() || worth.greatest().is_none() {
            return Choice::new(self.learner.explore(), Chooser::Planner);
        }
        let chooser = match self.learner.decider() {
            Decider::Rules => Chooser::Rules,
            Decider::Plan => Chooser::Table,
        };
        Choice::new(explorer.exploit(worth), chooser)
    }

    /// Notes the outcome of the action chosen after the last [`observe`](Self::observe).
    pub fn update(&mut self, action: Action, outcome: Outcome) -> StepCredit {
        let percept = self.percept.expect("`observe` comes before `update`");
        let matching = self.learner.matching(action);
        let found = outcome.found();
        self.learner.act(&percept, action, outcome.into(), found);
        StepCredit {
            short_term_reward: self.params.short_term(outcome),
            match_set: matching.match_set,
            action_set: matching.action_set,
            fired: matching.fittest.map(|rule| rule.condition),
            ..StepCredit::default()
        }
    }

    /// Ends the episode: corrects map, plan and policy.
    pub fn end_episode(&mut self, reached_goal: bool) -> EndCredit {
        self.learner.finish(reached_goal);
        EndCredit {
            long_term_reward: if reached_goal { self.params.goal } else { 0.0 },
            learning_rate: 1.0,
            imprinted: false,
        }
    }

    /// Returns the policy's action values where an episode begins with a percept.
    pub fn values(&self, percept: &Percept) -> PredictionArray {
        self.learner.worth_at_first(percept)
    }

    /// What was learned so far.
    pub fn knowledge(&self) -> Knowledge {
        match self.learner.decider() {
            Decider::Rules => Knowledge::Remembering {
                rules: self.learner.rules().clone(),
                map: self.learner.map().clone(),
            },
            Decider::Plan => Knowledge::Planned(self.learner.planned()),
        }
    }

    /// Starts from rules and maps of another world. A plan is not taken over.
    pub fn warm_start(&mut self, rules: &Population, map: &Map) -> bool {
        let takes = self.learner.decider() == Decider::Rules;
        if takes {
            self.learner.bring(rules, map);
        }
        takes
    }

    /// The number of rules, or of beliefs that were planned for.
    pub fn size(&self) -> usize {
        self.learner.size()
    }

    /// Learns from a step and the percept after it, `None` at a goal, whether several cells share a percept; `true` once
    /// that is certain.
    pub fn notices_aliasing(
        &mut self,
        step: (&Percept, Action, Outcome),
        next: Option<&Percept>,
    ) -> bool {
        self.learner.notices_aliasing(step, next)
    }

    /// Counts cells that successive percepts of an episode show differently; `true` once observation errors are so
    /// frequent that a percept cannot be taken for the state.
    pub fn notices_noise(&mut self, steps: &[(Percept, Action, Outcome)]) -> bool {
        self.learner.notices_noise(steps)
    }

    /// What learning has changed, as bytes for [`resume`](Self::resume).
    pub fn checkpoint(&self) -> Vec<u8> {
        memory::of(&self.learner.kept())
    }

    /// Resumes from [`checkpoint`](Self::checkpoint); `false` if that was made with other settings.
    ///
    /// # Errors
    /// When the bytes are damaged.
    pub fn resume(&mut self, saved: &[u8]) -> Result<bool, MemoryError> {
        Ok(self.learner.resume(memory::recall(saved)?))
    }
}
