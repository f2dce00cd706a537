//! Learner trials.

use std::ops::ControlFlow;

use pyo3::prelude::*;
use xcscr_learner::agent::Knowledge;
use xcscr_learner::episode::{Ending, Episode};
use xcscr_learner::trial::{Plan, Trial};
use xcscr_robot::world::Cell;

use crate::plan::{Choice, invalid, warn};

/// The number of episodes between two checks for signals such as Ctrl-C.
const EPISODES_AT_ONCE: u32 = 16;

/// A finished trial.
#[pyclass(frozen, module = "xcscr._native")]
pub struct Trained {
    plan: Plan,
    knowledge: Knowledge,
    episodes: Vec<Row>,
    #[pyo3(get)]
    first_optimal_episode: Option<u32>,
    #[pyo3(get)]
    retained: bool,
    path: Option<Vec<(u16, u16)>>,
}

/// The statistics of an episode, and whether the greedy policy was optimal after it.
type Row = (u32, u32, u32, u32, f64, bool, usize, bool);

/// A rule: condition in words, action, prediction, error, experience.
type Words = (String, String, f64, f64, u32);

fn row(episode: &Episode, is_optimal: bool) -> Row {
    (
        episode.episode,
        episode.steps,
        episode.collisions,
        episode.explored,
        episode.reward,
        episode.ending == Ending::Goal,
        episode.rules,
        is_optimal,
    )
}

/// Runs a trial of one method.
#[pyfunction]
#[pyo3(signature = (choice, method, episodes))]
pub fn train(py: Python<'_>, choice: Choice, method: &str, episodes: u32) -> PyResult<Trained> {
    let plan = choice.plan(Some(method), episodes)?;
    warn(py, std::iter::once(plan.clone()))?;
    py.detach(|| {
        let mut trial = Trial::new(plan).map_err(invalid)?;
        let mut rows = Vec::new();
        while !trial.is_finished() {
            run_episodes(&mut trial, &mut rows);
            Python::attach(|py| py.check_signals())?;
        }
        Ok(Trained::new(&trial, rows))
    })
}

/// Runs some episodes of a trial, and adds a row for each.
fn run_episodes(trial: &mut Trial, rows: &mut Vec<Row>) {
    for _ in 0..EPISODES_AT_ONCE {
        if trial.is_finished() {
            break;
        }
        let (episode, flow) = trial.run_episode(&mut ());
        debug_assert_eq!(flow, ControlFlow::Continue(()), "never interrupted");
        rows.push(row(&episode, trial.progress().optimal));
    }
}

#[pymethods]
impl Trained {
    /// Returns a row for each episode: episode, steps, collisions, explored, reward, reached, rules, optimal.
    fn rows(&self) -> Vec<Row> {
        self.episodes.clone()
    }

    /// Returns the fewest rules that keep all decisions: condition in words, action, prediction, error, experience. Empty for tables and plans.
    fn rules(&self, py: Python<'_>) -> Vec<Words> {
        py.detach(|| self.described())
    }

    /// Returns the cells of the greedy path from the start; `None` if episodes start anywhere.
    #[getter]
    fn greedy_path(&self) -> Option<Vec<(u16, u16)>> {
        self.path.clone()
    }

    /// Returns the name of the method.
    #[getter]
    fn method(&self) -> &'static str {
        self.plan.config.method.name()
    }

    /// Returns the name of the world.
    #[getter]
    fn world(&self) -> &str {
        self.plan.maze.name()
    }
}

impl Trained {
    fn new(trial: &Trial, episodes: Vec<Row>) -> Self {
        let cells = |path: Vec<Cell>| path.iter().map(|cell| (cell.col, cell.row)).collect();
        Self {
            knowledge: trial.method().knowledge(),
            episodes,
            first_optimal_episode: trial.progress().first_optimal_episode,
            retained: trial.progress().optimal,
            path: trial.greedy_path().map(cells),
            plan: trial.plan().clone(),
        }
    }

    fn described(&self) -> Vec<Words> {
        let Plan { maze, config } = &self.plan;
        let few = self.knowledge.with_fewest_rules(config.perception(), maze);
        let rules = few.rules().map_or(&[][..], |rules| rules.rules());
        let mut rules: Vec<_> = rules.iter().collect();
        rules.sort_by_key(|rule| std::cmp::Reverse(rule.experience));
        let described = rules.into_iter().map(|rule| {
            let words = config.sensor.words(maze, &rule.condition);
            let action = maze.action_name(rule.action);
            (words, action, rule.prediction, rule.error, rule.experience)
        });
        described.collect()
    }
}
