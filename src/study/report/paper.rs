//! Comparison of a study with the numbers of the paper.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use super::comparisons::p_value;
use super::results::shown;
use crate::page::Table;
use crate::sensor::Sensor;
use crate::study::analysis::summary::ArmRecords;
use crate::study::protocol::{Arm, Protocol, Variant};
use crate::study::statistics::{Proportion, fisher_exact, holm, quantile, rounded, trials_needed};

/// The numbers of the paper.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Paper {
    episodes: u32,
    trials: u64,
    /// The last episode of an early success, by world.
    early: BTreeMap<String, u32>,
    /// The number of successful trials, by method and world.
    successes: BTreeMap<String, BTreeMap<String, u64>>,
    pub readings: Vec<Reading>,
}

/// A passage of the paper that can be read in several ways.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reading {
    /// The setting that selects the reading.
    pub setting: String,
    pub passage: String,
}

impl Paper {
    /// Returns the successes of a method in a world, and the last episode of an early success.
    fn numbers(&self, method: &str, world: &str) -> Option<(Proportion, u32)> {
        let successes = *self.successes.get(method)?.get(world)?;
        let early = *self.early.get(world)?;
        Some((Proportion::new(successes, self.trials), early))
    }
}

/// The paper that introduced XCSCR.
pub static PAPER: LazyLock<Paper> = LazyLock::new(|| {
    toml::from_str(include_str!("paper.toml")).expect("the embedded numbers are valid")
});

/// An arm whose experiment the paper also reports.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AgainstPaper {
    /// The world.
    pub world: String,
    /// The learning method.
    pub method: &'static str,
    /// The arena.
    pub arena: &'static str,
    /// Successes of 100 in the paper.
    pub paper: u64,
    /// Successes here.
    pub successes: u64,
    /// Trials here.
    pub trials: u64,
    /// Fisher's exact p that both shares are the same.
    pub fisher_p: f64,
    /// `fisher_p` after Holm's correction over all rows.
    pub holm_p: f64,
    /// The difference in units of its standard error.
    pub z: f64,
    /// The median first optimal episode of the successful trials.
    pub median_of_successes: Option<f64>,
    /// The episode up to which a success counts as early.
    pub early_episode: u32,
    /// The share of the successes that were early.
    pub early: Option<f64>,
}

impl AgainstPaper {
    /// Returns the arms whose experiment the paper reports: in its mazes, with its percept and
    /// number of episodes, and without swept settings.
    pub fn all(arms: &[ArmRecords<'_>], protocol: &Protocol) -> Vec<Self> {
        let of_sweep = Self::of_sweep(arms, protocol).into_iter();
        let plain = of_sweep.filter(|(variant, _)| variant.0.is_empty());
        let mut rows: Vec<Self> = plain.map(|(_, row)| row).collect();
        let tests: Vec<f64> = rows.iter().map(|row| row.fisher_p).collect();
        for (row, holm_p) in rows.iter_mut().zip(holm(&tests)) {
            row.holm_p = rounded(holm_p);
        }
        rows
    }

    /// Like [`Self::all`], with swept settings and without Holm's correction.
    pub(super) fn of_sweep(arms: &[ArmRecords<'_>], protocol: &Protocol) -> Vec<(Variant, Self)> {
        let is_theirs = |one: &&ArmRecords<'_>| {
            let Arm { world, sensor, .. } = one.arm;
            *sensor == Sensor::Neighbours && protocol.has_shipped(world)
        };
        match protocol.episodes {
            episodes if episodes == PAPER.episodes => arms
                .iter()
                .filter(is_theirs)
                .filter_map(|one| Some((one.arm.variant.clone(), Self::new(one)?)))
                .collect(),
            _ => Vec::new(),
        }
    }

    fn new(records: &ArmRecords<'_>) -> Option<Self> {
        let arm = records.arm;
        let (theirs, early_episode) = PAPER.numbers(arm.built_in()?.name(), &arm.world)?;
        let ours = records.successes();
        let firsts = records.first_episodes();
        let early = firsts
            .iter()
            .filter(|first| **first <= f64::from(early_episode))
            .count();
        let share = early as f64 / firsts.len().max(1) as f64;
        Some(Self {
            world: arm.world.clone(),
            method: arm.method.name(),
            arena: arm.arena.name(),
            paper: theirs.successes,
            successes: ours.successes,
            trials: ours.trials,
            fisher_p: rounded(fisher_exact(ours, theirs)),
            holm_p: 1.0,
            z: rounded(standard_score(ours, theirs)),
            median_of_successes: quantile(&firsts, 0.5),
            early_episode,
            early: (!firsts.is_empty()).then_some(rounded(share)),
        })
    }
}

/// Returns the difference of two shares in units of its standard error. One success and one failure
/// are added to the pooled counts, so that the result is finite.
fn standard_score(a: Proportion, b: Proportion) -> f64 {
    let (n, m) = (a.trials.max(1) as f64, b.trials as f64);
    let pooled = (a.successes + b.successes + 1) as f64 / (n + m + 2.0);
    (a.share() - b.share()) / (pooled * (1.0 - pooled) * (1.0 / n + 1.0 / m)).sqrt()
}

/// Formats the comparison as a table.
pub fn table(rows: &[AgainstPaper]) -> Table {
    let share = |row: &AgainstPaper| 100.0 * row.successes as f64 / row.trials.max(1) as f64;
    let table = Table::of(
        rows,
        &[
            ("world", &|row| row.world.clone()),
            ("method", &|row| row.method.to_owned()),
            ("arena", &|row| row.arena.to_owned()),
            ("paper", &|row| row.paper.to_string()),
            ("here", &|row| row.successes.to_string()),
            ("of", &|row| row.trials.to_string()),
            ("points", &|row| {
                format!("{:+.0}", share(row) - row.paper as f64)
            }),
            ("Fisher p", &|row| p_value(row.fisher_p)),
            ("Holm p", &|row| p_value(row.holm_p)),
            ("median of successes", &|row| shown(row.median_of_successes)),
            ("early", &|row| {
                let words = |early| format!("{:.0} % by {}", 100.0 * early, row.early_episode);
                shown(row.early.map(words))
            }),
        ],
    );
    table.without_dull(|name| name == "arena")
}

/// Describes the agreement of the study with the paper in sentences.
pub fn verdict(rows: &[AgainstPaper]) -> String {
    let far: Vec<&AgainstPaper> = rows.iter().filter(|row| row.holm_p < 0.05).collect();
    let distance: f64 = rows.iter().map(|row| row.z * row.z).sum();
    let names: Vec<String> = far
        .iter()
        .map(|row| format!("{} in {}", row.method, row.world))
        .collect();
    let differ = match names.len() {
        0 => "none of them differs from the paper by more than chance explains (Fisher, Holm, 5 %)"
            .to_owned(),
        count => format!(
            "{count} {} from the paper by more than chance explains (Fisher, Holm, 5 %): {}",
            if count == 1 { "differs" } else { "differ" },
            names.join(", ")
        ),
    };
    format!(
        "Of {} numbers, {differ}. The sum of the squared standard scores is {distance:.0}; by chance \
         it would be about {}.",
        rows.len(),
        rows.len()
    )
}

/// Describes what a comparison with the paper leaves open.
pub fn limits(rows: &[AgainstPaper]) -> String {
    let near = rows.iter().filter(|row| row.holm_p >= 0.05).count();
    let of = |method| {
        PAPER
            .numbers(method, "maze4")
            .map(|(successes, _)| successes)
    };
    let own = of("xcscr").zip(of("adapted-even"));
    let own = own.map_or(String::new(), |(a, b)| {
        let p = p_value(fisher_exact(a, b));
        let needed = trials_needed(a.share(), b.share()).unwrap_or(0);
        format!(
            " Its own {} against {} of {} in Maze4 cannot be decided either: p = {p}; it would take \
             {needed} trials of each method.",
            a.successes, b.successes, a.trials
        )
    });
    format!(
        "{near} of {} numbers do not differ significantly from the paper's. This does not make them the \
         same: 100 trials against 100 miss differences of up to about 20 points one time in five. The \
         paper prints neither its seeds nor all of its settings; other settings may give the same \
         numbers.{own}",
        rows.len()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(world: &str, holm_p: f64) -> AgainstPaper {
        AgainstPaper {
            world: world.to_owned(),
            method: "xcs",
            arena: "grid",
            paper: 7,
            successes: 12,
            trials: 100,
            fisher_p: holm_p,
            holm_p,
            z: 1.0,
            median_of_successes: None,
            early_episode: 50,
            early: None,
        }
    }

    #[test]
    fn one_number_differs_and_two_differ() {
        let near = row("maze4", 0.5);
        let (five, six) = (row("maze5", 0.01), row("maze6", 0.02));
        let said = verdict(&[near.clone(), five.clone()]);
        assert!(
            said.contains("1 differs from") && said.contains(": xcs in maze5"),
            "{said}"
        );
        let said = verdict(&[near, five, six]);
        assert!(said.contains("2 differ from"), "{said}");
    }
}
