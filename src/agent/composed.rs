//! A model-based learner: state estimator x model x planner x policy (`xcscr-plus`, and `r-max` without rules).
//!
//! The learner begins with the percept as its state. Once its own experience contradicts that, the state becomes a cell
//! of a map that the learner draws itself. Three observations contradict it: one percept and action have led to more
//! states than slips explain; successive percepts disagree about cells that both show; an auxiliary reward was found,
//! which is paid once.

use serde::{Deserialize, Serialize};

use super::explorer::Explorer;
use super::knowledge::Knowledge;
use super::map_learner::MapLearner;
use super::memory::{self, MemoryError};
use super::percept_learner::PerceptLearner;
use super::{Agent, Choice, EndCredit, StepCredit};
use crate::arena::Outcome;
use xcs::{Action, Percept, PredictionArray};

/// An episode of so many steps, or of a power of two times as many, is examined before it ends.
const FIRST_EXAMINED: usize = 64;

/// What the state is taken for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Estimator {
    /// The percept, until experience contradicts that; then the cell on a map.
    #[default]
    Auto,
    /// The percept.
    Percept,
    /// The cell on a map that the learner draws.
    Map,
}

/// The learner of the present estimator.
#[derive(Debug, Clone)]
enum Current {
    Percept(Box<PerceptLearner>),
    Map,
}

/// The methods `xcscr-plus` and `r-max`.
#[derive(Debug, Clone)]
pub struct Composed {
    current: Current,
    /// Untrained but for its noise estimate, until it is needed.
    map: MapLearner,
    /// May the estimator change? Only where percepts show the cells around the robot, which maps are drawn from.
    adapts: bool,
    step_threshold: u32,
    /// The steps of this episode, as long as the estimator may change.
    steps: Vec<(Percept, Action, Outcome)>,
}

impl Composed {
    /// Creates an untrained learner that begins with `estimator`, or with the percept if `auto` may change it. `Auto`
    /// needs percepts that begin with the eight cells around the robot.
    pub fn new(
        estimator: Estimator,
        percept: PerceptLearner,
        map: MapLearner,
        step_threshold: u32,
    ) -> Self {
        Self {
            current: match estimator {
                Estimator::Map => Current::Map,
                Estimator::Auto | Estimator::Percept => Current::Percept(Box::new(percept)),
            },
            map,
            adapts: estimator == Estimator::Auto,
            step_threshold,
            steps: Vec::new(),
        }
    }

    /// Does experience contradict that the percept is the state?
    fn is_refuted(&self) -> bool {
        match &self.current {
            Current::Percept(learner) => {
                self.adapts && (self.found_reward() || learner.is_refuted())
            }
            Current::Map => false,
        }
    }

    /// Was an auxiliary reward found in this episode? It is paid once, which no percept shows.
    fn found_reward(&self) -> bool {
        self.steps
            .iter()
            .any(|(_, _, outcome)| outcome.found() != 0.0)
    }

    /// Takes the cell on a map as the state from now on, and lets the map learner live through this episode again.
    fn change_to_map(&mut self) {
        self.current = Current::Map;
        for (percept, action, outcome) in std::mem::take(&mut self.steps) {
            self.map.observe(&percept);
            self.map.update(action, outcome);
        }
    }
}

impl Agent for Composed {
    fn begin(&mut self, _: bool) {
        if let Current::Percept(learner) = &mut self.current {
            learner.begin();
        }
    }

    fn consider(&mut self, percept: &Percept) -> PredictionArray {
        let steps = self.steps.len();
        if steps >= FIRST_EXAMINED && steps.is_power_of_two() && self.is_refuted() {
            self.change_to_map();
        }
        match &mut self.current {
            Current::Percept(learner) => learner.observe(percept),
            Current::Map => self.map.observe(percept),
        }
    }

    fn choose(&mut self, worth: &PredictionArray, explorer: &mut Explorer) -> Choice {
        match &mut self.current {
            Current::Percept(learner) => learner.choose(worth, explorer),
            Current::Map => self.map.choose(worth, explorer),
        }
    }

    fn credit(&mut self, action: Action, outcome: Outcome) -> StepCredit {
        match &mut self.current {
            Current::Percept(learner) => {
                if self.adapts {
                    self.steps.push((learner.percept(), action, outcome));
                }
                learner.update(action, outcome)
            }
            Current::Map => self.map.update(action, outcome),
        }
    }

    fn finish(&mut self, reached_goal: bool) -> EndCredit {
        let Current::Percept(learner) = &mut self.current else {
            return self.map.end_episode(reached_goal);
        };
        let credit = learner.end_episode(reached_goal);
        let is_noisy = self.adapts && self.map.notices_noise(&self.steps);
        if is_noisy || self.is_refuted() {
            self.change_to_map();
            self.map.end_episode(reached_goal);
        }
        self.steps.clear();
        credit
    }

    fn step_threshold(&self) -> u32 {
        self.step_threshold
    }

    fn worth(&self, percept: &Percept) -> PredictionArray {
        match &self.current {
            Current::Percept(learner) => learner.values(percept),
            Current::Map => self.map.values(percept),
        }
    }

    fn knowledge(&self) -> Knowledge {
        match &self.current {
            Current::Percept(learner) => learner.knowledge(),
            Current::Map => self.map.knowledge(),
        }
    }

    /// Takes over the map of another world only if maps may be drawn.
    fn bring(&mut self, knowledge: &Knowledge) -> bool {
        match (knowledge, &mut self.current) {
            (Knowledge::Foresighted { foresight, .. }, Current::Percept(learner)) => {
                learner.warm_start(foresight);
                true
            }
            (Knowledge::Remembering { rules, map }, current) => {
                let may_draw = self.adapts || matches!(current, Current::Map);
                let takes = may_draw && self.map.warm_start(rules, map);
                if takes {
                    *current = Current::Map;
                }
                takes
            }
            _ => false,
        }
    }

    fn remembers(&self) -> bool {
        matches!(self.current, Current::Map)
    }

    fn rule_count(&self) -> usize {
        match &self.current {
            Current::Percept(learner) => learner.size(),
            Current::Map => self.map.size(),
        }
    }

    fn memory(&self) -> Vec<u8> {
        let percept = match &self.current {
            Current::Percept(learner) => Some(learner.checkpoint()),
            Current::Map => None,
        };
        memory::of(&(percept, self.map.checkpoint()))
    }

    fn restored(&self, saved: &[u8]) -> Result<Box<dyn Agent>, MemoryError> {
        let mut method = self.clone();
        let (percept, map): (Option<Vec<u8>>, Vec<u8>) = memory::recall(saved)?;
        let fits = match (percept, &mut method.current) {
            (Some(saved), Current::Percept(learner)) => learner.resume(&saved)?,
            (None, current) => {
                let may_draw = self.adapts || matches!(current, Current::Map);
                *current = Current::Map;
                may_draw
            }
            (Some(_), Current::Map) => false,
        };
        let fits = method.map.resume(&map)? && fits;
        memory::resumed(method, fits)
    }
}
