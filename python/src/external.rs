//! Agents that are written in Python.

use std::collections::BTreeSet;
use std::panic::resume_unwind;
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::conversion::FromPyObjectOwned;
use pyo3::exceptions::{PyOverflowError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use xcs::{Action, Percept, PredictionArray};
use xcscr::agent::{
    Agent, Choice, DecisionSource, EndCredit, Explorer, Knowledge, StepCredit, Transition,
};
use xcscr::arena::Outcome;
use xcscr::trial::{Plan, Settings};

use crate::plan::invalid;

/// The first exception of a study: of an agent, or Ctrl-C.
#[derive(Clone, Default)]
pub struct Fault(Arc<Mutex<Option<PyErr>>>);

impl Fault {
    /// Stores an exception, unless there is one.
    pub fn set(&self, error: PyErr) {
        let mut first = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        first.get_or_insert(error);
    }

    /// Is there an exception?
    pub fn is_set(&self) -> bool {
        let first = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        first.is_some()
    }

    /// Raises the exception, if there is one.
    pub fn check(&self) -> PyResult<()> {
        let mut first = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        first.take().map_or(Ok(()), Err)
    }

    /// Returns a value, or ends the trial with the exception. The study catches the unwinding.
    fn or_end<T>(&self, result: PyResult<T>) -> T {
        result.unwrap_or_else(|error| {
            let text = format!("the agent raised {error}");
            self.set(error);
            resume_unwind(Box::new(text))
        })
    }
}

/// An agent of one trial, which is an object of Python.
pub struct External {
    agent: Py<PyAny>,
    fault: Fault,
    settings: Settings,
    actions: usize,
    chooses: bool,
    /// The percepts whose values are part of the knowledge.
    known: BTreeSet<Percept>,
}

/// A percept as bytes of 0 or 1.
fn bits<'py>(py: Python<'py>, percept: &Percept) -> Bound<'py, PyBytes> {
    let bits = (0..percept.width()).map(|at| u8::from(percept.bit(at)));
    PyBytes::new(py, &bits.collect::<Vec<u8>>())
}

/// Converts what a method of an agent returned.
fn extract<'py, T: FromPyObjectOwned<'py, Error = PyErr>>(
    method: &str,
    answer: &Bound<'py, PyAny>,
    wanted: &str,
) -> PyResult<T> {
    let py = answer.py();
    let is_wrong = |fault: &PyErr| {
        fault.is_instance_of::<PyTypeError>(py)
            || fault.is_instance_of::<PyValueError>(py)
            || fault.is_instance_of::<PyOverflowError>(py)
    };
    answer.extract().map_err(|fault| match is_wrong(&fault) {
        true => unusable(method, answer, wanted),
        false => fault,
    })
}

/// Returns the error for an answer that has another type, or a number out of range.
fn unusable(method: &str, answer: &Bound<'_, PyAny>, wanted: &str) -> PyErr {
    let text = answer.repr().map(|text| text.to_string());
    let shown: String = text.unwrap_or_default().chars().take(200).collect();
    invalid(format!(
        "`{method}` returned {shown}, but must return {wanted}"
    ))
}

impl External {
    /// Builds the agent of a trial.
    pub fn new(class: &Py<PyAny>, plan: &Plan, fault: Fault) -> Self {
        let (maze, config) = (&plan.maze, &plan.config);
        let (actions, width) = (maze.action_count(), config.perception().width(maze));
        let built = Python::attach(|py| {
            let arguments = PyDict::new(py);
            arguments.set_item("n_actions", actions)?;
            arguments.set_item("n_bits", width)?;
            arguments.set_item("seed", config.seed)?;
            let agent = class.bind(py).call((), Some(&arguments))?;
            let chooses = agent.hasattr("choose")?;
            Ok((agent.unbind(), chooses))
        });
        let (agent, chooses) = fault.or_end(built);
        let percepts = (!maze.is_too_large())
            .then(|| config.perception().at_most_percepts(maze, usize::MAX))
            .flatten();
        Self {
            agent,
            fault,
            settings: config.settings.clone(),
            actions,
            chooses,
            known: percepts.into_iter().flatten().collect(),
        }
    }

    fn ask<T>(&self, ask: impl FnOnce(&Bound<'_, PyAny>) -> PyResult<T>) -> T {
        let answer = Python::attach(|py| ask(self.agent.bind(py)));
        self.fault.or_end(answer)
    }

    /// Teaches a step; `next` is `None` at a goal.
    fn learn(&self, percept: &Percept, action: Action, reward: f64, next: Option<&Percept>) {
        self.ask(|agent| {
            let py = agent.py();
            let next = next.map(|next| bits(py, next));
            let step = (bits(py, percept), action.index(), reward, next);
            agent.call_method1("learn", step).map(drop)
        });
    }

    fn ask_values(&self, agent: &Bound<'_, PyAny>, percept: &Percept) -> PyResult<PredictionArray> {
        let answer = agent.call_method1("values", (bits(agent.py(), percept),))?;
        let wanted = "a sequence with a finite number, or `None`, for each action";
        let values: Vec<Option<f64>> = extract("values", &answer, wanted)?;
        if values.len() != self.actions {
            return Err(invalid(format!(
                "`values` returned {} numbers for {} actions",
                values.len(),
                self.actions
            )));
        }
        let mut array = PredictionArray::new(self.actions);
        for (action, value) in Action::all(self.actions).zip(values) {
            match value {
                Some(value) if value.is_finite() => array.set(action, value),
                Some(_) => return Err(unusable("values", &answer, wanted)),
                None => {}
            }
        }
        Ok(array)
    }

    fn ask_action(&self, agent: &Bound<'_, PyAny>, percept: &Percept) -> PyResult<Action> {
        let answer = agent.call_method1("choose", (bits(agent.py(), percept),))?;
        let wanted = format!("an action from 0 to {}", self.actions - 1);
        let number: usize = extract("choose", &answer, &wanted)?;
        let action = Action::new(number).filter(|action| action.index() < self.actions);
        action.ok_or_else(|| unusable("choose", &answer, &wanted))
    }
}

impl Agent for External {
    fn observe(&mut self, percept: &Percept) -> PredictionArray {
        self.known.insert(*percept);
        self.values(percept)
    }

    fn choose(
        &mut self,
        percept: &Percept,
        values: &PredictionArray,
        explorer: &mut Explorer,
    ) -> Choice {
        if self.chooses {
            let action = self.ask(|agent| self.ask_action(agent, percept));
            return Choice::new(action, DecisionSource::Table);
        }
        let (action, explores) = explorer.choose(values);
        Choice::by(DecisionSource::Table, action, explores)
    }

    fn update(&mut self, step: &Transition<'_>) -> StepCredit {
        let rewards = &self.settings.reward;
        let short_term_reward = rewards.short_term(step.outcome);
        let at_goal = if step.outcome == Outcome::ReachedGoal {
            rewards.goal
        } else {
            0.0
        };
        self.learn(
            step.percept,
            step.action,
            short_term_reward + at_goal,
            step.next,
        );
        StepCredit {
            short_term_reward,
            ..StepCredit::default()
        }
    }

    fn end_episode(&mut self, reached_goal: bool) -> EndCredit {
        self.ask(|agent| agent.call_method1("end_episode", (reached_goal,)).map(drop));
        EndCredit {
            long_term_reward: if reached_goal {
                self.settings.reward.goal
            } else {
                0.0
            },
            learning_rate: 0.0,
            imprinted: false,
        }
    }

    fn step_threshold(&self) -> u32 {
        self.settings.reward.step_threshold
    }

    fn values(&self, percept: &Percept) -> PredictionArray {
        self.ask(|agent| self.ask_values(agent, percept))
    }

    fn knowledge(&self) -> Knowledge {
        let row = |percept: &Percept| (*percept, self.values(percept).as_slice().to_vec());
        Knowledge::Table(self.known.iter().map(row).collect())
    }

    fn rule_count(&self) -> usize {
        self.ask(|agent| match agent.hasattr("__len__")? {
            true => agent.len(),
            false => Ok(0),
        })
    }
}
