//! A model-based learner: state estimator x model x planner x policy (`xcscr-plus`, and `r-max` without
//! rules).
//!
//! At first the percept is the state. Once the learner's experience contradicts that, the state becomes a
//! cell of a learned map. Contradictions are:
//! * One percept and one move have led to different percepts.
//! * Moves slip, and an action had more results than slips explain.
//! * Successive percepts disagree about cells that both show.
//! * An auxiliary reward was collected, which is paid once.
//! * No move slips, but the policy takes more steps than there are percepts.

mod environment_learner;
mod map_learner;
mod params;
mod percept_learner;

pub use environment_learner::{EnvironmentLearner, EnvironmentParams};
pub use map_learner::MapLearner;
pub use params::PlusParams;
pub use percept_learner::PerceptLearner;

use crate::agent::estimator::Estimator;
use crate::agent::knowledge::Knowledge;
use crate::agent::policy::explorer::Explorer;
use crate::agent::{Agent, Choice, EndCredit, StepCredit};
use xcs::{Action, Percept, PredictionArray};
use xcscr_robot::arena::Outcome;

/// The learner of the current state estimator.
#[derive(Debug, Clone)]
enum Current {
    /// The percept is the state. The waiting map learner is untrained but for its noise estimate; it is
    /// `None` if the percept remains the state.
    Percept(Box<PerceptLearner>, Option<Box<MapLearner>>),
    /// The cell on a map is the state.
    Map(Box<MapLearner>),
}

/// The methods `xcscr-plus` and `r-max`.
#[derive(Debug, Clone)]
pub struct Composed {
    current: Current,
    /// The steps of this episode, as long as the estimator may change.
    steps: Vec<(Percept, Action, Outcome)>,
    /// The number of last steps chosen by the policy, without exploration or chance.
    exploited: usize,
}

impl Composed {
    /// Creates an untrained learner that begins with `estimator`, or with the percept for `Auto`. `Auto`
    /// requires percepts that begin with the eight cells around the robot.
    pub fn new(estimator: Estimator, percept: PerceptLearner, map: MapLearner) -> Self {
        let (percept, map) = (Box::new(percept), Box::new(map));
        Self {
            current: match estimator {
                Estimator::Auto => Current::Percept(percept, Some(map)),
                Estimator::Percept => Current::Percept(percept, None),
                Estimator::Map => Current::Map(map),
            },
            steps: Vec::new(),
            exploited: 0,
        }
    }

    fn learner(&self) -> &dyn Agent {
        match &self.current {
            Current::Percept(learner, _) => &**learner,
            Current::Map(learner) => &**learner,
        }
    }

    fn learner_mut(&mut self) -> &mut dyn Agent {
        match &mut self.current {
            Current::Percept(learner, _) => &mut **learner,
            Current::Map(learner) => &mut **learner,
        }
    }

    /// Checks the last step and the next percept (`None` at a goal) for a contradiction to the percept as
    /// the state. Returns `true` if there is one.
    fn is_contradicted(&mut self, next: Option<&Percept>) -> bool {
        let Current::Percept(learner, Some(map)) = &mut self.current else {
            return false;
        };
        let Some((percept, action, outcome)) = self.steps.last() else {
            return false;
        };
        // An auxiliary reward is paid once, which no percept shows.
        let found = outcome.found() != 0.0;
        // A policy over states arrives or explores before it visits a state twice.
        let circles = learner.has_met_fewer_than(self.exploited);
        map.notices_aliasing((percept, *action, *outcome), next) || found || circles
    }

    /// Returns true if experience up to the end of an episode refutes the percept as the state.
    fn is_refuted(&mut self) -> bool {
        let Current::Percept(learner, waiting) = &mut self.current else {
            return false;
        };
        let steps = &self.steps;
        let is_noisy = waiting.as_mut().is_some_and(|map| map.notices_noise(steps));
        is_noisy || learner.is_refuted()
    }

    /// Switches to the cell on a map as the state, if possible, and replays this episode to the map
    /// learner.
    fn change_to_map(&mut self) {
        let Current::Percept(_, waiting) = &mut self.current else {
            return;
        };
        let Some(mut map) = waiting.take() else {
            return;
        };
        for (percept, action, outcome) in std::mem::take(&mut self.steps) {
            map.observe(&percept);
            map.update(action, outcome);
        }
        self.current = Current::Map(map);
    }
}

impl Agent for Composed {
    fn begin_episode(&mut self, evolves: bool) {
        self.learner_mut().begin_episode(evolves);
    }

    fn observe(&mut self, percept: &Percept) -> PredictionArray {
        if self.is_contradicted(Some(percept)) {
            self.change_to_map();
        }
        self.learner_mut().observe(percept)
    }

    fn choose(&mut self, values: &PredictionArray, explorer: &mut Explorer) -> Choice {
        let choice = self.learner_mut().choose(values, explorer);
        self.exploited = match choice.explores() {
            true => 0,
            false => self.exploited + 1,
        };
        choice
    }

    fn update(&mut self, action: Action, outcome: Outcome) -> StepCredit {
        if let Current::Percept(learner, Some(_)) = &self.current {
            self.steps.push((learner.percept(), action, outcome));
        }
        self.learner_mut().update(action, outcome)
    }

    fn end_episode(&mut self, reached_goal: bool) -> EndCredit {
        let contradicted = reached_goal && self.is_contradicted(None);
        let was_map = self.remembers();
        let credit = self.learner_mut().end_episode(reached_goal);
        if self.is_refuted() || contradicted {
            self.change_to_map();
        }
        if self.remembers() && !was_map {
            self.learner_mut().end_episode(reached_goal);
        }
        self.steps.clear();
        self.exploited = 0;
        credit
    }

    fn step_threshold(&self) -> u32 {
        self.learner().step_threshold()
    }

    fn values(&self, percept: &Percept) -> PredictionArray {
        self.learner().values(percept)
    }

    fn knowledge(&self) -> Knowledge {
        self.learner().knowledge()
    }

    /// Switches to a map if the knowledge has one.
    fn warm_start(&mut self, knowledge: &Knowledge) -> bool {
        if matches!(knowledge, Knowledge::MapRules { .. }) {
            self.change_to_map();
        }
        self.learner_mut().warm_start(knowledge)
    }

    fn remembers(&self) -> bool {
        self.learner().remembers()
    }

    fn rule_count(&self) -> usize {
        self.learner().rule_count()
    }
}
