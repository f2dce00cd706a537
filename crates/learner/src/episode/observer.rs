//! Events of an episode for observers: recorders, progress bars, tests.

use std::ops::ControlFlow;

use crate::agent::{Agent, Chosen, DecisionSource, StepCredit};
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

/// One step: percept, choice, action, and outcome.
#[derive(Clone, Copy)]
pub struct Step<'a> {
    /// The episode's number, from 1.
    pub episode: u32,
    /// The step's number in the episode, from 1.
    pub step: u32,
    /// The cell of the robot before the step.
    pub cell: Cell,
    /// The percept in this cell.
    pub percept: Percept,
    /// The value of each action in this cell.
    pub values: PredictionArray,
    /// The action that was chosen.
    pub action: Action,
    /// The decision source.
    pub source: DecisionSource,
    /// True if the action was chosen to explore.
    pub explored: bool,
    /// The outcome of the action.
    pub outcome: Outcome,
    /// The credit that the method assigned.
    pub credit: StepCredit,
    /// The view of the arena after the step.
    pub view: View<'a>,
    /// The learner after the step.
    pub method: &'a dyn Agent,
}

impl Step<'_> {
    /// Returns the condition of the rule of \[A\] with the greatest weight, if rules chose the
    /// action.
    pub fn fired(&self) -> Option<Condition> {
        self.credit
            .fired
            .filter(|_| self.source == DecisionSource::Rules)
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
    /// The number of steps by decision source.
    pub chosen: Chosen,
    /// The sum of all rewards: short-term rewards and the long-term reward.
    pub reward: f64,
    /// The step-threshold of the next episode.
    pub step_threshold: u32,
    /// The learning rate at the end of the episode.
    pub learning_rate: f64,
    /// Steps after which the short-term filter lowered a value.
    pub filter_firings: u32,
    /// True if a policy was imprinted at the end.
    pub imprinted: bool,
    /// Macro-classifiers in \[P\], or stored pairs of a tabular method.
    pub rules: usize,
}

/// An observer of episodes. Every method does nothing by default.
///
/// For each episode, [`began`](Self::began) is called first, then [`stepped`](Self::stepped) for
/// each step, then [`ended`](Self::ended).
pub trait Observer {
    /// Called when the robot is at the start of `episode` (counted from 1).
    fn began(&mut self, episode: u32, view: &View<'_>) {
        let _ = (episode, view);
    }

    /// Called when a step was taken and credited.
    fn stepped(&mut self, step: &Step<'_>) {
        let _ = step;
    }

    /// Called when the episode is over and credited. [`ControlFlow::Break`] ends the trial.
    fn ended(&mut self, episode: &Episode, after: &AfterEpisode<'_>) -> ControlFlow<()> {
        let _ = (episode, after);
        ControlFlow::Continue(())
    }
}

/// An observer that does nothing.
impl Observer for () {}

impl<O: Observer + ?Sized> Observer for &mut O {
    fn began(&mut self, episode: u32, view: &View<'_>) {
        (**self).began(episode, view);
    }

    fn stepped(&mut self, step: &Step<'_>) {
        (**self).stepped(step);
    }

    fn ended(&mut self, episode: &Episode, after: &AfterEpisode<'_>) -> ControlFlow<()> {
        (**self).ended(episode, after)
    }
}

/// Two observers; the trial ends when either returns [`ControlFlow::Break`].
impl<A: Observer, B: Observer> Observer for (A, B) {
    fn began(&mut self, episode: u32, view: &View<'_>) {
        self.0.began(episode, view);
        self.1.began(episode, view);
    }

    fn stepped(&mut self, step: &Step<'_>) {
        self.0.stepped(step);
        self.1.stepped(step);
    }

    fn ended(&mut self, episode: &Episode, after: &AfterEpisode<'_>) -> ControlFlow<()> {
        let first = self.0.ended(episode, after);
        let second = self.1.ended(episode, after);
        first?;
        second
    }
}

/// The learner and the robot at the end of an episode.
#[derive(Clone, Copy)]
pub struct AfterEpisode<'a> {
    /// The learner.
    pub method: &'a dyn Agent,
    /// The sensor of the robot.
    pub sensor: Sensor,
    /// The view of the arena at the end of the episode.
    pub view: View<'a>,
}
