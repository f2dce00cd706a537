//! `/episode`: that an episode runs, at its start; its figures, at its end.

use foxglove::Schema;
use serde::Serialize;

use super::decimal;
use super::schema::{Kind, object};
use crate::episode::{Ending, Episode};

/// What the policy would do now, seen from where the episode started.
#[derive(Debug, Clone, Copy, Serialize)]
pub(in crate::record) struct Outlook {
    /// Is it globally optimal?
    pub optimal: bool,
    /// Its steps to a goal, if it gets there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub greedy_steps: Option<u32>,
    /// The fewest steps that anyone needs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shortest: Option<u32>,
}

/// The figures of an episode.
#[derive(Debug, Serialize)]
pub(in crate::record) struct EpisodeRecord {
    episode: u32,
    ended: u32,
    outcome: Ending,
    steps: u32,
    collisions: u32,
    explored: u32,
    reward: f64,
    rules: usize,
    step_threshold: u32,
    learning_rate: f64,
    imprinted: bool,
    #[serde(flatten)]
    outlook: Outlook,
}

impl EpisodeRecord {
    pub fn new(episode: &Episode, outlook: Outlook) -> Self {
        Self {
            episode: episode.episode,
            ended: episode.episode,
            outcome: episode.ending,
            steps: episode.steps,
            collisions: episode.collisions,
            explored: episode.explored,
            reward: decimal(episode.reward),
            rules: episode.rules,
            step_threshold: episode.step_threshold,
            learning_rate: decimal(episode.learning_rate),
            imprinted: episode.imprinted,
            outlook,
        }
    }
}

/// An episode that runs; what its end will tell is left out.
#[derive(Debug, Serialize)]
pub(in crate::record) struct Running {
    episode: u32,
    outcome: &'static str,
    optimal: bool,
}

impl Running {
    /// Episode `episode` begins, while the greedy policy is optimal or not.
    pub fn new(episode: u32, optimal: bool) -> Self {
        Self {
            episode,
            outcome: "running",
            optimal,
        }
    }
}

pub(super) fn schema() -> Schema {
    let fields = [
        ("episode", Kind::Count, "from 1"),
        ("ended", Kind::Count, "the same, once it is over"),
        (
            "outcome",
            Kind::Text,
            "running, goal, or step-limit; the rest is told at the end",
        ),
        ("steps", Kind::Count, "steps taken"),
        ("collisions", Kind::Count, "steps that hit a wall"),
        ("explored", Kind::Count, "steps chosen by chance"),
        ("reward", Kind::Number, "sum of all rewards"),
        ("rules", Kind::Count, "macro-classifiers in [P]"),
        (
            "step_threshold",
            Kind::Count,
            "most steps of the next episode",
        ),
        (
            "learning_rate",
            Kind::Number,
            "with which the end was learned",
        ),
        ("imprinted", Kind::Bool, "stored policy imprinted?"),
        ("optimal", Kind::Bool, "greedy policy globally optimal?"),
        (
            "greedy_steps",
            Kind::Count,
            "of the greedy policy from this start; absent: never arrives",
        ),
        (
            "shortest",
            Kind::Count,
            "steps of the shortest path from this start",
        ),
    ];
    object("xcscr.Episode", &fields)
}
