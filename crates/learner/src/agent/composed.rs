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

use crate::agent::explorer::Explorer;
use crate::agent::knowledge::Knowledge;
use crate::agent::map_learner::MapLearner;
use crate::agent::percept_learner::PerceptLearner;
use crate::agent::plus_params::Estimator;
use crate::agent::saved::{self, RestoreError};
use crate::agent::{Agent, Choice, Chooser, EndCredit, StepCredit};
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
    step_threshold: u32,
    /// The steps of this episode, as long as the estimator may change.
    steps: Vec<(Percept, Action, Outcome)>,
    /// The number of last steps chosen by the policy, without exploration or chance.
    exploited: usize,
}

impl Composed {
    /// Creates an untrained learner that begins with `estimator`, or with the percept for `Auto`. `Auto`
    /// requires percepts that begin with the eight cells around the robot.
    pub fn new(
        estimator: Estimator,
        percept: PerceptLearner,
        map: MapLearner,
        step_threshold: u32,
    ) -> Self {
        let (percept, map) = (Box::new(percept), Box::new(map));
        Self {
            current: match estimator {
                Estimator::Auto => Current::Percept(percept, Some(map)),
                Estimator::Percept => Current::Percept(percept, None),
                Estimator::Map => Current::Map(map),
            },
            step_threshold,
            steps: Vec::new(),
            exploited: 0,
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
    fn begin_episode(&mut self, _: bool) {
        if let Current::Percept(learner, _) = &mut self.current {
            learner.begin();
        }
    }

    fn observe(&mut self, percept: &Percept) -> PredictionArray {
        if self.is_contradicted(Some(percept)) {
            self.change_to_map();
        }
        match &mut self.current {
            Current::Percept(learner, _) => learner.observe(percept),
            Current::Map(learner) => learner.observe(percept),
        }
    }

    fn choose(&mut self, values: &PredictionArray, explorer: &mut Explorer) -> Choice {
        let choice = match &mut self.current {
            Current::Percept(learner, _) => learner.choose(values, explorer),
            Current::Map(learner) => return learner.choose(values, explorer),
        };
        self.exploited = match choice.chooser {
            Chooser::Rules | Chooser::Table => self.exploited + 1,
            Chooser::Planner | Chooser::Chance => 0,
        };
        choice
    }

    fn update(&mut self, action: Action, outcome: Outcome) -> StepCredit {
        match &mut self.current {
            Current::Percept(learner, waiting) => {
                if waiting.is_some() {
                    self.steps.push((learner.percept(), action, outcome));
                }
                learner.update(action, outcome)
            }
            Current::Map(learner) => learner.update(action, outcome),
        }
    }

    fn end_episode(&mut self, reached_goal: bool) -> EndCredit {
        let contradicted = reached_goal && self.is_contradicted(None);
        let (learner, waiting) = match &mut self.current {
            Current::Percept(learner, waiting) => (learner, waiting),
            Current::Map(learner) => return learner.end_episode(reached_goal),
        };
        let credit = learner.end_episode(reached_goal);
        let contradicted = contradicted || learner.is_refuted();
        let steps = &self.steps;
        let is_noisy = waiting.as_mut().is_some_and(|map| map.notices_noise(steps));
        if is_noisy || contradicted {
            self.change_to_map();
            if let Current::Map(learner) = &mut self.current {
                learner.end_episode(reached_goal);
            }
        }
        self.steps.clear();
        self.exploited = 0;
        credit
    }

    fn step_threshold(&self) -> u32 {
        self.step_threshold
    }

    fn values(&self, percept: &Percept) -> PredictionArray {
        match &self.current {
            Current::Percept(learner, _) => learner.values(percept),
            Current::Map(learner) => learner.values(percept),
        }
    }

    fn knowledge(&self) -> Knowledge {
        match &self.current {
            Current::Percept(learner, _) => learner.knowledge(),
            Current::Map(learner) => learner.knowledge(),
        }
    }

    /// Takes over the map of another world only if maps may be used.
    fn warm_start(&mut self, knowledge: &Knowledge) -> bool {
        match knowledge {
            Knowledge::Foresighted { generalisation, .. } => match &mut self.current {
                Current::Percept(learner, _) => {
                    learner.warm_start(generalisation);
                    true
                }
                Current::Map(_) => false,
            },
            Knowledge::Remembering { rules, map } => {
                self.change_to_map();
                match &mut self.current {
                    Current::Map(learner) => learner.warm_start(rules, map),
                    Current::Percept(..) => false,
                }
            }
            _ => false,
        }
    }

    fn remembers(&self) -> bool {
        matches!(self.current, Current::Map(_))
    }

    fn rule_count(&self) -> usize {
        match &self.current {
            Current::Percept(learner, _) => learner.size(),
            Current::Map(learner) => learner.size(),
        }
    }

    fn checkpoint(&self) -> Vec<u8> {
        let state: (Option<Vec<u8>>, Option<Vec<u8>>) = match &self.current {
            Current::Percept(learner, waiting) => {
                let waiting = waiting.as_ref().map(|map| map.checkpoint());
                (Some(learner.checkpoint()), waiting)
            }
            Current::Map(learner) => (None, Some(learner.checkpoint())),
        };
        saved::bytes_of(&state)
    }

    fn restore(&self, saved: &[u8]) -> Result<Box<dyn Agent>, RestoreError> {
        let mut method = self.clone();
        let (percept, map): (Option<Vec<u8>>, Option<Vec<u8>>) = saved::read(saved)?;
        if percept.is_none() {
            method.change_to_map();
        }
        let fits = match (&mut method.current, percept, map) {
            (Current::Percept(learner, None), Some(percept), None) => learner.resume(&percept)?,
            (Current::Percept(learner, Some(waiting)), Some(percept), Some(map)) => {
                learner.resume(&percept)? && waiting.resume(&map)?
            }
            (Current::Map(learner), None, Some(map)) => learner.resume(&map)?,
            _ => false,
        };
        saved::accept(method, fits)
    }
}
