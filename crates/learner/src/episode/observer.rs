//! What an episode tells to whoever listens: recorders, progress bars, tests.

use std::ops::ControlFlow;

use crate::agent::{Agent, Chooser, Chosen, StepCredit};
use xcs::{Action, Percept};
use xcs::{Condition, PredictionArray};
use xcscr_robot::arena::{Outcome, View};
use xcscr_robot::sensor::Sensor;
use xcscr_robot::world::Cell;

/// How an episode ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ending {
    /// The robot reached a goal.
    Goal,
    /// The robot took as many steps as the step-threshold allows.
    StepLimit,
}

/// One step: what was perceived, chosen and done, and what came of it.
#[derive(Clone, Copy)]
pub struct Step<'a> {
    /// The episode's number, from 1.
    pub episode: u32,
    /// The step's number in the episode, from 1.
    pub step: u32,
    /// The cell in which the robot stood before.
    pub cell: Cell,
    /// The percept there.
    pub percept: Percept,
    /// The value of each action there.
    pub values: PredictionArray,
    /// The action that was chosen.
    pub action: Action,
    /// Who chose it.
    pub chooser: Chooser,
    /// Was it chosen to explore?
    pub explored: bool,
    /// What came of it.
    pub outcome: Outcome,
    /// What the reward method made of it.
    pub credit: StepCredit,
    /// What can be seen after it.
    pub view: View<'a>,
    /// The learner, after it.
    pub method: &'a dyn Agent,
}

impl Step<'_> {
    /// The condition of the rule that decided, where rules did: that of \[A\] that weighs most.
    pub fn fired(&self) -> Option<Condition> {
        self.credit.fired.filter(|_| self.chooser == Chooser::Rules)
    }
}

/// The figures of a finished episode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Episode {
    /// The episode's number, from 1.
    pub episode: u32,
    /// How it ended.
    pub ending: Ending,
    /// Steps taken.
    pub steps: u32,
    /// Steps that ended in a collision.
    pub collisions: u32,
    /// Steps that were chosen to explore.
    pub explored: u32,
    /// Who chose its steps.
    pub chosen: Chosen,
    /// The sum of all rewards: short-term ones and the one at the end.
    pub reward: f64,
    /// The step-threshold that will hold in the next episode.
    pub step_threshold: u32,
    /// The learning rate with which the end of the episode was learned.
    pub learning_rate: f64,
    /// Was a policy imprinted at the end?
    pub imprinted: bool,
    /// Macro-classifiers in \[P\], or stored pairs of a tabular method.
    pub rules: usize,
}

/// Listens to episodes. Every method does nothing unless it is written.
///
/// For each episode come, in this order: [`began`](Self::began), [`stepped`](Self::stepped) for
/// each step, [`ended`](Self::ended).
pub trait Observer {
    /// The robot stands at the start of `episode` (counted from 1).
    fn began(&mut self, episode: u32, view: &View<'_>) {
        let _ = (episode, view);
    }

    /// A step was taken and credited.
    fn stepped(&mut self, step: &Step<'_>) {
        let _ = step;
    }

    /// The episode is over and learned. [`ControlFlow::Break`] ends the trial after it.
    fn ended(&mut self, episode: &Episode, learned: &Learned<'_>) -> ControlFlow<()> {
        let _ = (episode, learned);
        ControlFlow::Continue(())
    }
}

/// Nobody listens.
impl Observer for () {}

impl<O: Observer + ?Sized> Observer for &mut O {
    fn began(&mut self, episode: u32, view: &View<'_>) {
        (**self).began(episode, view);
    }

    fn stepped(&mut self, step: &Step<'_>) {
        (**self).stepped(step);
    }

    fn ended(&mut self, episode: &Episode, learned: &Learned<'_>) -> ControlFlow<()> {
        (**self).ended(episode, learned)
    }
}

/// Two listen; the trial ends when either wants it to.
impl<A: Observer, B: Observer> Observer for (A, B) {
    fn began(&mut self, episode: u32, view: &View<'_>) {
        self.0.began(episode, view);
        self.1.began(episode, view);
    }

    fn stepped(&mut self, step: &Step<'_>) {
        self.0.stepped(step);
        self.1.stepped(step);
    }

    fn ended(&mut self, episode: &Episode, learned: &Learned<'_>) -> ControlFlow<()> {
        let first = self.0.ended(episode, learned);
        let second = self.1.ended(episode, learned);
        first?;
        second
    }
}

/// What was learned so far, and where the last episode left the robot.
#[derive(Clone, Copy)]
pub struct Learned<'a> {
    /// The learner.
    pub method: &'a dyn Agent,
    /// How it perceives.
    pub sensor: Sensor,
    /// What can be seen at the end of the episode.
    pub view: View<'a>,
}
