//! `trials.csv` and `summary.json`, for other programs.

use serde::Serialize;

use super::summary::{ArmSummary, rounded};
use crate::study::error::StudyError;
use crate::study::protocol::Protocol;
use crate::study::store::folder::StudyFolder;
use crate::study::store::{Figures, TrialRecord};
use crate::trial::Progress;

/// A row of `trials.csv`; fields without a value are empty.
#[derive(Debug, Serialize)]
struct TrialRow<'a> {
    world: &'a str,
    method: &'a str,
    arena: &'static str,
    sensor: &'static str,
    variant: String,
    trial: usize,
    seed: u64,
    first_optimal_episode: Option<u32>,
    first_optimal_env_steps: Option<u64>,
    first_executed_optimal_episode: Option<u32>,
    retained: Option<bool>,
    optimal_share_after_first: Option<f64>,
    steps: Option<u64>,
    collisions: Option<u64>,
    observation_errors: Option<u64>,
    mislocalised: Option<u64>,
    chosen_by_rules: Option<u64>,
    chosen_by_table: Option<u64>,
    chosen_by_planner: Option<u64>,
    chosen_by_chance: Option<u64>,
    most_rules: Option<usize>,
    rules: Option<usize>,
    compacted_rules: Option<usize>,
    greedy_steps: Option<f64>,
    greedy_ratio: Option<f64>,
    driven_goals: Option<u32>,
    driven_optimal: Option<u32>,
    driven_steps: Option<f64>,
    error: String,
}

impl<'a> TrialRow<'a> {
    fn new(protocol: &'a Protocol, record: &'a TrialRecord) -> Self {
        let arm = protocol.arm(record.trial);
        let figures = record.figures();
        let driven = figures.and_then(|one| one.driven);
        let progress = figures.map(|Figures { progress, .. }| progress);
        Self {
            world: &arm.world,
            method: arm.method_name(),
            arena: arm.arena.name(),
            sensor: arm.sensor.name(),
            variant: arm.variant.to_string(),
            trial: protocol.replicate(record.trial),
            seed: protocol.trial_seed(record.trial),
            first_optimal_episode: progress.and_then(|one| one.first_optimal_episode),
            first_optimal_env_steps: progress.and_then(|one| one.first_optimal_env_steps),
            first_executed_optimal_episode: progress
                .and_then(|one| one.first_executed_optimal_episode),
            retained: progress.map(|one| one.optimal),
            optimal_share_after_first: progress
                .and_then(Progress::optimal_share_after_first)
                .map(rounded),
            steps: progress.map(|one| one.steps),
            collisions: progress.map(|one| one.collisions),
            observation_errors: progress.map(|one| one.mistakes.observation_error),
            mislocalised: progress.map(|one| one.mistakes.mislocalised),
            chosen_by_rules: progress.map(|one| one.chosen.rules),
            chosen_by_table: progress.map(|one| one.chosen.table),
            chosen_by_planner: progress.map(|one| one.chosen.planner),
            chosen_by_chance: progress.map(|one| one.chosen.chance),
            most_rules: progress.map(|one| one.most_rules),
            rules: figures.map(|one| one.rules),
            compacted_rules: figures.and_then(|one| one.compacted_rules),
            greedy_steps: figures.and_then(|one| one.greedy_steps).map(rounded),
            greedy_ratio: figures.and_then(|one| one.greedy_ratio).map(rounded),
            driven_goals: driven.map(|one| one.goals),
            driven_optimal: driven.map(|one| one.optimal),
            driven_steps: driven.map(|one| rounded(one.steps)),
            error: record
                .result
                .as_ref()
                .err()
                .map_or_else(String::new, |fault| plain(fault)),
        }
    }
}

/// Replaces control characters, which could control a terminal: journals may come from elsewhere.
fn plain(message: &str) -> String {
    let letters = message.chars();
    letters
        .map(|letter| if letter.is_control() { ' ' } else { letter })
        .collect()
}

/// The contents of `summary.json`.
#[derive(Debug, Serialize)]
struct Summary<'a> {
    study: &'a str,
    plan: String,
    version: &'a str,
    seed: u64,
    episodes: u32,
    arms: Vec<ArmSummary>,
}

impl StudyFolder {
    /// Returns the summary as a JSON document.
    pub fn summary_json(&self) -> String {
        let protocol = self.protocol();
        let summary = Summary {
            study: &protocol.name,
            plan: self.plan().to_owned(),
            version: &protocol.version,
            seed: protocol.seed,
            episodes: protocol.episodes,
            arms: ArmSummary::all(self),
        };
        let text = serde_json::to_string_pretty(&summary).expect("plain data becomes JSON");
        text + "\n"
    }

    /// Writes `trials.csv` and `summary.json`.
    ///
    /// # Errors
    /// An error of the file system.
    pub fn write_tables(&self) -> Result<(), StudyError> {
        self.write_with("trials.csv", |file| {
            let mut table = csv::Writer::from_writer(file);
            for record in self.records() {
                table.serialize(TrialRow::new(self.protocol(), &record))?;
            }
            table.flush()
        })?;
        self.write("summary.json", self.summary_json().as_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_in_a_message_are_replaced_in_the_table() {
        assert_eq!(plain("a \u{1b}[31mred\n\u{9b}2J ü"), "a  [31mred  2J ü");
    }
}
