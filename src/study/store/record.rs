//! The stored record of a finished trial.

use std::panic::{AssertUnwindSafe, catch_unwind};

use serde::{Deserialize, Serialize};

use crate::episode::Episode;
use crate::study::custom::Agents;
use crate::study::protocol::Protocol;
use crate::trial::{Compacted, Evaluation, GreedySteps, Plan, Progress, Trial};

/// The figures of a trial that ran to its end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// The progress of the trial.
    pub progress: Progress,
    /// Number of rules at the end.
    pub rules: usize,
    /// Number of these rules after compaction; `None` for a table.
    pub compacted_rules: Option<usize>,
    /// Mean steps of the greedy policy over all starts, at the end.
    pub greedy_steps: Option<f64>,
    /// `greedy_steps` as a multiple of the optimum.
    pub greedy_ratio: Option<f64>,
    /// Share of the starts from which the greedy policy reaches a goal at the end, times the optimum as
    /// a share of its steps there. Unlike `greedy_steps`, it does not depend on the step limit.
    pub greedy_score: Option<f64>,
    /// Results of driving with the greedy policy at the end, if the study has `drives`.
    pub driven: Option<Driven>,
}

/// Results of driving the trial's own robot with the final greedy policy, without learning or
/// exploration. The robot has its sensors and its faults.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Driven {
    /// Number of episodes.
    pub episodes: u32,
    /// Number of episodes that reached a goal.
    pub goals: u32,
    /// Number of episodes that reached a goal in the minimum number of steps.
    pub optimal: u32,
    /// Mean number of steps per episode.
    pub steps: f64,
}

impl Driven {
    fn of(trial: &mut Trial, episodes: u32) -> Result<Self, String> {
        let driven = Evaluation::after(trial, episodes).map_err(|fault| fault.to_string())?;
        Ok(Self {
            episodes,
            goals: driven.successes,
            optimal: driven.optimal,
            steps: driven.mean_steps,
        })
    }

    /// Returns `some` as a share of all episodes.
    pub fn share(&self, some: u32) -> f64 {
        f64::from(some) / f64::from(self.episodes.max(1))
    }
}

/// A finished trial of a study: its number, and its figures or its error.
#[derive(Debug, Clone, PartialEq)]
pub struct TrialRecord {
    /// The trial's number in the study, from 0.
    pub trial: usize,
    /// Its figures, or its error.
    pub result: Result<Figures, String>,
}

/// Maximum size of the error of a trial.
const MOST_ERROR_BYTES: usize = 4096;

impl TrialRecord {
    /// Runs a trial of a study to its end. An error of the trial, even a panic, becomes part of the
    /// record.
    pub(in crate::study) fn of(protocol: &Protocol, agents: &Agents, trial: usize) -> Self {
        Self::of_episodes(protocol, agents, trial, &mut |_, _| ())
    }

    /// The same as [`Self::of`]. Calls `each` with the trial after each episode.
    pub(in crate::study) fn of_episodes(
        protocol: &Protocol,
        agents: &Agents,
        trial: usize,
        each: &mut dyn FnMut(&Trial, &Episode),
    ) -> Self {
        let result = catch_unwind(AssertUnwindSafe(|| {
            let trial = self::trial(protocol, agents, trial)?;
            figures(&mut finished(trial, each), protocol.drives)
        }));
        let result = result.unwrap_or_else(|panic| Err(words(&*panic)));
        let result = result.map_err(shortened);
        Self { trial, result }
    }

    /// Returns true if both have the same figures, or both failed. The texts of errors may differ, as an address or a
    /// time in them does.
    pub(super) fn equals(&self, other: &Self) -> bool {
        match (&self.result, &other.result) {
            (Ok(one), Ok(other)) => one == other,
            (one, other) => one.is_err() == other.is_err(),
        }
    }

    /// Returns the figures, or `None` if the trial failed.
    pub fn figures(&self) -> Option<&Figures> {
        self.result.as_ref().ok()
    }
}

/// Prepares a trial of a study.
pub(in crate::study) fn trial(
    protocol: &Protocol,
    agents: &Agents,
    number: usize,
) -> Result<Trial, String> {
    let plan = protocol.plan(number);
    match &protocol.arm(number).agent {
        Some(name) => {
            let plan = plan.settled();
            let agent = agents.build(name, &plan)?;
            Trial::with_agent(plan, agent).map_err(|fault| fault.to_string())
        }
        None => Trial::new(plan).map_err(|fault| fault.to_string()),
    }
}

/// Returns the figures of a finished trial.
fn figures(trial: &mut Trial, drives: u32) -> Result<Figures, String> {
    let driven = (drives > 0).then(|| Driven::of(trial, drives));
    let Plan { maze, config } = trial.plan();
    let knowledge = trial.method().knowledge();
    let compacted = Compacted::new(&knowledge, config.perception(), maze, trial.paths());
    let greedy = GreedySteps::of(trial.plan(), &knowledge);
    Ok(Figures {
        progress: trial.progress().clone(),
        rules: trial.method().rule_count(),
        compacted_rules: compacted.map(|compacted| compacted.rules.len()),
        greedy_steps: Some(greedy.mean),
        greedy_ratio: greedy.ratio(trial.plan()),
        greedy_score: greedy_score(trial.plan(), greedy),
        driven: driven.transpose()?,
    })
}

/// Returns the score of a greedy policy, or `None` if the optimum is not known. Episodes that reach no
/// goal have taken as many steps as the step limit.
fn greedy_score(plan: &Plan, greedy: GreedySteps) -> Option<f64> {
    let optimum = greedy.mean / greedy.ratio(plan)?;
    let [all, arrived] = [greedy.episodes, greedy.arrivals].map(f64::from);
    if arrived == 0.0 {
        return Some(0.0);
    }
    let limit = f64::from(plan.config.settings.reward.step_threshold);
    let steps = greedy.mean * all - (all - arrived) * limit;
    Some((arrived / all * optimum / (steps / arrived)).clamp(0.0, 1.0))
}

/// Runs a trial to its end. Calls `each` after each episode.
fn finished(mut trial: Trial, each: &mut dyn FnMut(&Trial, &Episode)) -> Trial {
    while !trial.is_finished() {
        // An observer `()` never stops a run.
        let (episode, _) = trial.run_episode(&mut ());
        each(&trial, &episode);
    }
    trial
}

/// Cuts a long error, which may be a custom agent's. A journal has a line for each trial, and its
/// lines have a limit.
fn shortened(mut error: String) -> String {
    let most = MOST_ERROR_BYTES.min(error.len());
    let end = (0..=most).rfind(|&at| error.is_char_boundary(at));
    error.truncate(end.unwrap_or(0));
    error
}

/// Returns the message of a panic.
fn words(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied();
    let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    format!(
        "internal error: {}",
        text.unwrap_or("a panic without a message")
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::{Maze, Paths};

    #[test]
    fn the_score_of_a_policy_does_not_depend_on_the_step_limit() {
        for limit in [50_u32, 600] {
            let mut plan = Plan::new(Maze::load("worlds/maze4.json".as_ref()).unwrap());
            plan.config.settings.reward.step_threshold = limit;
            let optimum = f64::from(Paths::new(&plan.maze).longest(&plan.maze));
            let score = |arrivals: u32, steps: f64| {
                let failed = f64::from(4 - arrivals) * f64::from(limit);
                let mean = (f64::from(arrivals) * steps + failed) / 4.0;
                let greedy = GreedySteps {
                    mean,
                    arrivals,
                    episodes: 4,
                };
                greedy_score(&plan, greedy).unwrap()
            };
            assert!((score(4, optimum) - 1.0).abs() < 1e-9);
            assert!((score(4, 2.0 * optimum) - 0.5).abs() < 1e-9);
            assert!((score(1, 2.0 * optimum) - 0.125).abs() < 1e-9);
            assert_eq!(score(0, 0.0), 0.0);
        }
    }

    #[test]
    fn a_long_error_is_cut_between_two_characters() {
        let text = shortened("ä".repeat(3_000) + "x");
        assert_eq!(text, "ä".repeat(2_048));
        assert_eq!(shortened("x".to_owned() + &text).len(), 4_095);
        assert_eq!(shortened("short".to_owned()), "short");
    }
}
