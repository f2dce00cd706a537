//! What came out: a row for each arm.

use super::document::Table;
use crate::study::summary::ArmSummary;

/// What the columns mean.
pub const LEGEND: &str = "optimal: trials whose greedy policy became globally optimal, with \
    Wilson's interval. median, p95: the episode by which half, or 95 %, of all trials were optimal \
    (Kaplan-Meier; – when they never were). retained: still optimal after the last episode. steps: \
    environment steps until then, interquartile mean with bootstrap interval; trials without an \
    optimum count with all their steps. collisions, rules: means of a trial.";

/// A table of all arms. Columns that tell nothing apart are left out.
pub fn table(arms: &[ArmSummary]) -> Table {
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
    table.rows = arms.iter().map(row).collect();
    table.without_dull(|name| ["arena", "sensor", "variant", "failed"].contains(&name))
}

fn row(arm: &ArmSummary) -> Vec<String> {
    vec![
        arm.world.clone(),
        arm.method.to_owned(),
        arm.arena.to_owned(),
        arm.sensor.to_owned(),
        arm.variant.clone(),
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
