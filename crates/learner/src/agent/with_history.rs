//! A learner whose percepts are followed by the last steps of the episode.

use crate::agent::{
    Agent, Choice, EndCredit, Explorer, Knowledge, RuleUpdates, StepCredit, Transition,
};
use xcs::{Percept, PredictionArray};
use xcscr_robot::sensor::History;

/// Passes percepts with their history to a learner. The history is empty at the beginning of each episode.
pub struct WithHistory {
    agent: Box<dyn Agent>,
    beginning: History,
    history: History,
}

impl WithHistory {
    /// Adds a history to a learner; returns the learner itself if the history keeps no steps. `beginning` is the
    /// history at the beginning of an episode.
    pub fn around(agent: Box<dyn Agent>, beginning: History) -> Box<dyn Agent> {
        if !beginning.keeps_steps() {
            return agent;
        }
        Box::new(Self {
            agent,
            beginning,
            history: beginning,
        })
    }
}

impl Agent for WithHistory {
    fn begin_episode(&mut self, evolves: bool) {
        self.agent.begin_episode(evolves);
    }

    fn observe(&mut self, percept: &Percept) -> PredictionArray {
        self.agent.observe(&self.history.behind(percept))
    }

    fn choose(
        &mut self,
        percept: &Percept,
        values: &PredictionArray,
        explorer: &mut Explorer,
    ) -> Choice {
        let percept = self.history.behind(percept);
        self.agent.choose(&percept, values, explorer)
    }

    fn update(&mut self, step: &Transition<'_>) -> StepCredit {
        let percept = self.history.behind(step.percept);
        self.history = self.history.after(step.percept, step.action);
        let next = step.next.map(|next| self.history.behind(next));
        self.agent.update(&Transition {
            percept: &percept,
            next: next.as_ref(),
            ..*step
        })
    }

    fn end_episode(&mut self, reached_goal: bool) -> EndCredit {
        self.history = self.beginning;
        self.agent.end_episode(reached_goal)
    }

    fn step_threshold(&self) -> u32 {
        self.agent.step_threshold()
    }

    fn values(&self, percept: &Percept) -> PredictionArray {
        self.agent.values(percept)
    }

    fn knowledge(&self) -> Knowledge {
        self.agent.knowledge()
    }

    fn warm_start(&mut self, knowledge: &Knowledge) -> bool {
        self.agent.warm_start(knowledge)
    }

    fn rule_count(&self) -> usize {
        self.agent.rule_count()
    }

    fn rule_updates(&self) -> RuleUpdates {
        self.agent.rule_updates()
    }

    fn first_history(&self) -> History {
        self.beginning
    }
}
