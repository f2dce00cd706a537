//! A learner whose percepts are followed by the last steps of the episode.

use crate::agent::{Agent, Choice, EndCredit, Explorer, Knowledge, StepCredit};
use xcs::{Action, Percept, PredictionArray};
use xcscr_robot::arena::Outcome;
use xcscr_robot::sensor::History;

/// Passes percepts with their history to a learner. The history is empty at the beginning of each episode.
pub struct WithHistory {
    agent: Box<dyn Agent>,
    beginning: History,
    history: History,
    /// The current percept, without history.
    percept: Option<Percept>,
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
            percept: None,
        })
    }
}

impl Agent for WithHistory {
    fn begin_episode(&mut self, evolves: bool) {
        self.agent.begin_episode(evolves);
    }

    fn observe(&mut self, percept: &Percept) -> PredictionArray {
        self.percept = Some(*percept);
        self.agent.observe(&self.history.behind(percept))
    }

    fn choose(&mut self, values: &PredictionArray, explorer: &mut Explorer) -> Choice {
        self.agent.choose(values, explorer)
    }

    fn update(&mut self, action: Action, outcome: Outcome, next: Option<&Percept>) -> StepCredit {
        let percept = self.percept.expect("`observe` comes before `update`");
        self.history = self.history.after(&percept, action);
        let next = next.map(|next| self.history.behind(next));
        self.agent.update(action, outcome, next.as_ref())
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

    fn first_history(&self) -> History {
        self.beginning
    }
}
