//! `/episode`: at the start, that an episode runs; at the end, its figures. `/ended`: its number.

use super::Topic;
use super::fields::{Fields, fields};
use crate::agent::Knowledge;
use crate::episode::{Ending, Episode};
use xcs::{Classifier, Population, PredictionArray};

/// The policy at this time, evaluated from the episode's start.
#[derive(Debug, Clone, Copy)]
pub(in crate::record) struct Outlook {
    /// True if the policy is globally optimal.
    pub optimal: bool,
    /// The number of steps to a goal, if the greedy policy reaches one.
    pub greedy_steps: Option<u32>,
    /// The number of steps of the shortest path.
    pub shortest: Option<u32>,
    /// The value of each action in the start cell.
    pub start_values: PredictionArray,
}

/// Returns the message for the start of an episode, without the figures that are known at its end
/// only.
pub(in crate::record) fn running(episode: u32, optimal: bool) -> Fields {
    fields! { "episode.json":
        episode: episode,
        outcome: "running",
        state: Topic::Episode.number("state", "running"),
        policy: policy_number(optimal),
        optimal: optimal,
    }
}

/// Returns the figures of an episode.
pub(in crate::record) fn figures(
    episode: &Episode,
    knowledge: &Knowledge,
    outlook: &Outlook,
) -> Fields {
    let rules = knowledge.rules();
    let result = match episode.ending {
        Ending::StepLimit => "step limit",
        Ending::Goal => "goal",
    };
    fields! { "episode.json":
        episode: episode.episode,
        outcome: episode.ending,
        state: Topic::Episode.number("state", result),
        result: Topic::Episode.number("result", result),
        policy: policy_number(outlook.optimal),
        steps: episode.steps,
        collisions: episode.collisions,
        explored: episode.explored,
        reward: episode.reward,
        rules: episode.rules,
        micro: rules.map(Population::micro),
        generality: mean(rules, generality),
        mean_error: mean(rules, |rule| rule.error),
        step_threshold: episode.step_threshold,
        learning_rate: episode.learning_rate,
        imprinted: episode.imprinted,
        optimal: outlook.optimal,
        greedy_steps: outlook.greedy_steps,
        shortest: outlook.shortest,
        start_values: outlook.start_values.as_slice(),
    }
}

/// Returns the message that an episode is over.
pub(in crate::record) fn ended(episode: &Episode) -> Fields {
    fields! { "ended.json": episode: episode.episode, learning_rate: episode.learning_rate }
}

/// Returns the mean over the micro-classifiers of \[P\]; `None` for an empty population or a table.
fn mean(rules: Option<&Population>, of: fn(&Classifier) -> f64) -> Option<f64> {
    let rules = rules.filter(|rules| !rules.is_empty())?;
    let all = rules.rules().iter();
    let sum: f64 = all.map(|rule| f64::from(rule.numerosity) * of(rule)).sum();
    Some(sum / f64::from(rules.micro().max(1)))
}

/// Returns the share of don't-cares in the condition of a rule.
fn generality(rule: &Classifier) -> f64 {
    let (demands, width) = (rule.condition.specificity(), rule.condition.width());
    1.0 - demands as f64 / width.max(1) as f64
}

/// Returns the number that says whether the greedy policy is optimal.
fn policy_number(optimal: bool) -> Option<u64> {
    let name = if optimal { "optimal" } else { "not optimal" };
    Topic::Episode.number("policy", name)
}
