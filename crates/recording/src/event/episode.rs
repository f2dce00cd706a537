//! `/begin` and `/episode`: the start of an episode, and its figures at the end.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use xcs::{Classifier, Population, PredictionArray};
use xcscr_learner::agent::Knowledge;
use xcscr_learner::episode::{Ending, Episode};

/// The start of an episode.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Begin {
    /// Number of the episode, from 1.
    pub episode: u32,
    /// True if the greedy policy is globally optimal.
    pub optimal: bool,
}

/// The figures of an episode, at its end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct End {
    /// Number of the episode, from 1.
    pub episode: u32,
    /// Outcome: goal or step-limit.
    pub outcome: String,
    /// Steps taken.
    pub steps: u32,
    /// Steps that hit a wall.
    pub collisions: u32,
    /// Steps chosen to explore.
    pub explored: u32,
    /// Sum of all rewards.
    pub reward: f64,
    /// Macro-classifiers in \[P\].
    pub rules: u32,
    /// Micro-classifiers in \[P\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub micro: Option<u32>,
    /// Mean share of don't-care bits in the conditions of \[P\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub generality: Option<f64>,
    /// Mean prediction error in \[P\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_error: Option<f64>,
    /// Step limit of the next episode.
    pub step_threshold: u32,
    /// Learning rate at the end of the episode.
    pub learning_rate: f64,
    /// True if a stored policy was imprinted.
    pub imprinted: bool,
    /// True if the greedy policy is globally optimal.
    pub optimal: bool,
    /// Steps of the greedy policy from this start; absent if it does not reach a goal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub greedy_steps: Option<u32>,
    /// Steps of the shortest path from this start.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shortest: Option<u32>,
    /// Value of each action in the start cell, clockwise from north; null if unknown.
    pub start_values: Vec<Option<f64>>,
}

/// The policy at this time, evaluated from the episode's start.
#[derive(Debug, Clone, Copy)]
pub struct Outlook {
    /// True if the policy is globally optimal.
    pub optimal: bool,
    /// The number of steps to a goal, if the greedy policy reaches one.
    pub greedy_steps: Option<u32>,
    /// The number of steps of the shortest path.
    pub shortest: Option<u32>,
    /// The value of each action in the start cell.
    pub start_values: PredictionArray,
}

impl End {
    /// Creates the event of the end of an episode.
    pub fn of(episode: &Episode, knowledge: &Knowledge, outlook: &Outlook) -> Self {
        let rules = knowledge.rules();
        let outcome = match episode.ending {
            Ending::Goal => "goal",
            Ending::StepLimit => "step-limit",
        };
        Self {
            episode: episode.episode,
            outcome: outcome.to_owned(),
            steps: episode.steps,
            collisions: episode.collisions,
            explored: episode.explored,
            reward: episode.reward,
            rules: episode.rules as u32,
            micro: rules.map(Population::micro),
            generality: mean(rules, generality),
            mean_error: mean(rules, |rule| rule.error),
            step_threshold: episode.step_threshold,
            learning_rate: episode.learning_rate,
            imprinted: episode.imprinted,
            optimal: outlook.optimal,
            greedy_steps: outlook.greedy_steps,
            shortest: outlook.shortest,
            start_values: outlook.start_values.as_slice().to_vec(),
        }
    }
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
