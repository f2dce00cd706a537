//! `/episode`: at the start, that an episode runs; at the end, its figures.

use serde::{Deserialize, Serialize, Serializer};

use super::decimal;
use crate::agent::Knowledge;
use crate::episode::{Ending, Episode};
use xcs::{Classifier, PredictionArray};

/// The policy at this time, evaluated from the episode's start.
#[derive(Debug, Clone, Copy, Serialize)]
pub(in crate::record) struct Outlook {
    /// True if the policy is globally optimal.
    pub optimal: bool,
    /// The number of steps to a goal, if the greedy policy reaches one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub greedy_steps: Option<u32>,
    /// The number of steps of the shortest path.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shortest: Option<u32>,
    /// The value of each action in the start cell; null if unknown.
    #[serde(serialize_with = "decimals")]
    pub start_values: PredictionArray,
}

/// Serializes values as the rounded numbers of JSON messages.
pub(super) fn decimals<S: Serializer>(
    values: &PredictionArray,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(values.as_slice().iter().map(|one| one.map(decimal)))
}

/// The figures of an episode.
#[derive(Debug, Serialize)]
pub(in crate::record) struct EpisodeRecord {
    episode: u32,
    outcome: Ending,
    state: u8,
    result: u8,
    policy: u8,
    steps: u32,
    collisions: u32,
    explored: u32,
    reward: f64,
    rules: usize,
    #[serde(flatten)]
    population: Option<Population>,
    step_threshold: u32,
    learning_rate: f64,
    imprinted: bool,
    #[serde(flatten)]
    outlook: Outlook,
}

/// Statistics of the rules of \[P\]; means over its micro-classifiers.
#[derive(Debug, Clone, Copy, Serialize)]
pub(in crate::record) struct Population {
    micro: u32,
    /// The mean is omitted for an empty population.
    #[serde(skip_serializing_if = "Option::is_none")]
    generality: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mean_error: Option<f64>,
}

impl Population {
    /// Returns the statistics of the learned rules; `None` for a table.
    pub fn of(knowledge: &Knowledge) -> Option<Self> {
        let rules = knowledge.rules()?;
        let mean = |of: fn(&Classifier) -> f64| {
            let all = rules.rules().iter();
            let sum: f64 = all.map(|rule| f64::from(rule.numerosity) * of(rule)).sum();
            (!rules.is_empty()).then(|| decimal(sum / f64::from(rules.micro().max(1))))
        };
        Some(Self {
            micro: rules.micro(),
            generality: mean(|rule| {
                let (demands, width) = (rule.condition.specificity(), rule.condition.width());
                1.0 - demands as f64 / width.max(1) as f64
            }),
            mean_error: mean(|rule| rule.error),
        })
    }
}

/// Returns the number of whether the greedy policy is optimal, as in `episode.json`.
fn policy_number(optimal: bool) -> u8 {
    if optimal { 3 } else { 1 }
}

impl EpisodeRecord {
    pub fn new(episode: &Episode, population: Option<Population>, outlook: Outlook) -> Self {
        let result = match episode.ending {
            Ending::StepLimit => 1,
            Ending::Goal => 3,
        };
        Self {
            episode: episode.episode,
            outcome: episode.ending,
            state: result,
            result,
            policy: policy_number(outlook.optimal),
            steps: episode.steps,
            collisions: episode.collisions,
            explored: episode.explored,
            reward: decimal(episode.reward),
            rules: episode.rules,
            population,
            step_threshold: episode.step_threshold,
            learning_rate: decimal(episode.learning_rate),
            imprinted: episode.imprinted,
            outlook,
        }
    }
}

/// The message that an episode is over.
#[derive(Debug, Serialize)]
pub(in crate::record) struct Ended {
    episode: u32,
    learning_rate: f64,
}

impl Ended {
    pub fn new(episode: &Episode) -> Self {
        Self {
            episode: episode.episode,
            learning_rate: decimal(episode.learning_rate),
        }
    }
}

/// A running episode, without the figures that are known at its end only.
#[derive(Debug, Serialize)]
pub(in crate::record) struct Running {
    episode: u32,
    outcome: &'static str,
    state: u8,
    policy: u8,
    optimal: bool,
}

impl Running {
    /// Creates the message for the start of an episode.
    pub fn new(episode: u32, optimal: bool) -> Self {
        Self {
            episode,
            outcome: "running",
            state: 0,
            policy: policy_number(optimal),
            optimal,
        }
    }
}

/// The fields of a message that highlights show.
#[derive(Deserialize)]
pub(in crate::record) struct Figures {
    pub episode: u32,
    pub outcome: String,
    pub optimal: bool,
    pub steps: Option<u32>,
    pub collisions: Option<u32>,
    pub shortest: Option<u32>,
}
