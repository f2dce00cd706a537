//! What came out: a row for each arm.

use std::collections::BTreeSet;

use serde_json::Value;

use super::document::Table;
use crate::study::protocol::{Arm, Variant};
use crate::study::summary::ArmSummary;

/// What the columns mean.
pub const LEGEND: &str = "optimal: trials whose greedy policy became globally optimal, with \
    Wilson's interval. median, p95: the episode by which half, or 95 %, of all trials were optimal \
    (Kaplan-Meier; – when they never were). retained: still optimal after the last episode. steps: \
    environment steps until then, interquartile mean with bootstrap interval; trials without an \
    optimum count with all their steps. collisions, rules: means of a trial.";

/// Letters for the settings of a sweep, in the order of their names.
pub fn letters(arms: &[Arm]) -> Vec<(char, String)> {
    let keys = arms.iter().flat_map(|arm| arm.variant.0.keys().cloned());
    let keys: BTreeSet<String> = keys.collect();
    ('A'..='Z').zip(keys).collect()
}

/// What the letters mean; nothing without a sweep.
pub fn letters_legend(letters: &[(char, String)]) -> Option<String> {
    let words: Vec<String> = letters
        .iter()
        .map(|(letter, key)| format!("{letter} is `{key}`"))
        .collect();
    (!words.is_empty()).then(|| {
        format!(
            "In `variant`, {}; a letter alone is on, – is off.",
            words.join(", ")
        )
    })
}

/// The values of a variant behind their letters.
fn variant(variant: &Variant, letters: &[(char, String)]) -> String {
    let word = |(letter, key): &(char, String)| match variant.0.get(key) {
        Some(Value::Bool(true)) => letter.to_string(),
        Some(Value::Bool(false)) | None => "–".to_owned(),
        Some(Value::String(text)) => format!("{letter}={text}"),
        Some(value) => format!("{letter}={value}"),
    };
    letters.iter().map(word).collect::<Vec<_>>().join(" ")
}

/// A table of all arms and their summaries. Columns that tell nothing apart are left out.
pub fn table(arms: &[Arm], summaries: &[ArmSummary]) -> Table {
    let mut table = Table::new([
        "world",
        "method",
        "arena",
        "sensor",
        "variant",
        "optimal",
        "of",
        "95 % interval",
        "median",
        "p95",
        "retained",
        "steps (IQM)",
        "95 % interval ",
        "collisions",
        "rules",
        "failed",
    ]);
    let letters = letters(arms);
    let rows = arms.iter().zip(summaries);
    table.rows = rows
        .map(|(arm, one)| row(one, variant(&arm.variant, &letters)))
        .collect();
    table.without_dull(|name| ["arena", "sensor", "variant", "failed"].contains(&name))
}

fn row(arm: &ArmSummary, variant: String) -> Vec<String> {
    vec![
        arm.world.clone(),
        arm.method.to_owned(),
        arm.arena.to_owned(),
        arm.sensor.to_owned(),
        variant,
        arm.successes.to_string(),
        arm.trials.to_string(),
        percent_range(arm.wilson_low, arm.wilson_high),
        arm.median_episode
            .map_or("–".to_owned(), |episode| episode.to_string()),
        arm.p95_episode
            .map_or("–".to_owned(), |episode| episode.to_string()),
        arm.retained.to_string(),
        arm.iqm_env_steps
            .map_or("–".to_owned(), |steps| format!("{steps:.0}")),
        arm.iqm_env_steps_low
            .zip(arm.iqm_env_steps_high)
            .map_or("–".to_owned(), |(low, high)| {
                format!("{low:.0}–{high:.0}")
            }),
        format!("{:.0}", arm.mean_collisions),
        format!("{:.0}", arm.mean_rules),
        arm.failed.to_string(),
    ]
}

/// Two shares as a range of percents.
pub fn percent_range(low: f64, high: f64) -> String {
    format!("{:.0}–{:.0} %", 100.0 * low, 100.0 * high)
}
