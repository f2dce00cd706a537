//! The table of results, with a row for each arm.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::page::Table;
use crate::study::analysis::summary::ArmSummary;
use crate::study::protocol::{Arm, Variant};

/// A description in each line, after the name of one or more columns.
const LEGEND: &str = include_str!("legend.txt");

/// Describes the columns of a table of results.
pub fn legend(table: &Table) -> String {
    let is_shown = |line: &&str| {
        let name = line.split([':', ',']).next().unwrap_or_default();
        let mut columns = table.header.iter();
        columns.any(|column| column == name || column.strip_suffix(" (IQM)") == Some(name))
    };
    let shown = LEGEND.lines().filter(is_shown);
    shown.collect::<Vec<_>>().join(" ")
}

/// Assigns letters to the settings of a sweep, in the order of their names.
pub fn letters(arms: &[Arm]) -> Vec<(String, String)> {
    let keys = arms.iter().flat_map(|arm| arm.variant.0.keys().cloned());
    let keys: BTreeSet<String> = keys.collect();
    let letter = |at: usize| {
        char::from(b'A' + (at % 26) as u8)
            .to_string()
            .repeat(1 + at / 26)
    };
    (0..).map(letter).zip(keys).collect()
}

/// Describes the letters, or returns `None` without a sweep.
pub fn letters_legend(letters: &[(String, String)]) -> Option<String> {
    if let [(_, only)] = letters {
        return Some(format!("variant: the value of `{only}`."));
    }
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

/// Formats the values of a variant with their letters.
fn variant(variant: &Variant, letters: &[(String, String)]) -> String {
    if let [(_, only)] = letters {
        let value = variant.0.get(only);
        return value.map_or("–".to_owned(), |v| {
            v.as_str().map_or(v.to_string(), str::to_owned)
        });
    }
    let word = |(letter, key): &(String, String)| {
        Some(match variant.0.get(key)? {
            Value::Bool(true) => letter.clone(),
            Value::Bool(false) => "–".to_owned(),
            Value::String(text) => format!("{letter}={text}"),
            value => format!("{letter}={value}"),
        })
    };
    letters
        .iter()
        .filter_map(word)
        .collect::<Vec<_>>()
        .join(" ")
}

/// Formats all arms and their summaries as a table. Constant columns are left out.
pub fn table(arms: &[Arm], summaries: &[ArmSummary]) -> Table {
    let letters = letters(arms);
    let rows = arms.iter().zip(summaries);
    let table = Table::of(
        rows,
        &[
            ("world", &|(_, one)| one.world.clone()),
            ("method", &|(_, one)| one.method.clone()),
            ("arena", &|(_, one)| one.arena.to_owned()),
            ("sensor", &|(_, one)| one.sensor.to_owned()),
            ("variant", &|(arm, _)| variant(&arm.variant, &letters)),
            ("memory", &|(_, one)| {
                let word = if one.needs_memory { "needed" } else { "–" };
                word.to_owned()
            }),
            ("solved", &|(_, one)| one.successes.to_string()),
            ("of", &|(_, one)| one.trials.to_string()),
            ("95 % interval", &|(_, one)| {
                let limits = Some((one.wilson_low, one.wilson_high));
                percents(limits.filter(|_| one.trials > 0))
            }),
            ("retained", &|(_, one)| one.retained.to_string()),
            ("stays optimal", &|(_, one)| {
                percent(one.mean_optimal_share_after_first)
            }),
            ("median", &|(_, one)| shown(one.median_episode)),
            ("p95", &|(_, one)| shown(one.p95_episode)),
            ("steps (IQM)", &|(_, one)| whole(one.iqm_env_steps)),
            ("steps: 95 %", &|(_, one)| {
                let limits = one.iqm_env_steps_low.zip(one.iqm_env_steps_high);
                shown(limits.map(|(low, high)| format!("{low:.0}–{high:.0}")))
            }),
            ("score", &|(_, one)| {
                shown(one.mean_greedy_score.map(|mean| format!("{mean:.2}")))
            }),
            ("driven", &|(_, one)| percent(one.driven_goals)),
            ("driven: 95 %", &|(_, one)| {
                percents(one.driven_always_low.zip(one.driven_always_high))
            }),
            ("shortest", &|(_, one)| percent(one.driven_optimal)),
            ("driven steps", &|(_, one)| {
                shown(one.driven_steps.map(|steps| format!("{steps:.1}")))
            }),
            ("obs. errors", &|(_, one)| {
                per_mille(one.observation_error_share)
            }),
            ("mislocalised", &|(_, one)| {
                per_mille(one.mislocalised_share)
            }),
            ("collisions", &|(_, one)| whole(one.mean_collisions)),
            ("rules", &|(_, one)| whole(one.mean_rules)),
            ("compacted", &|(_, one)| {
                let counts = one.median_compacted_rules.zip(one.most_compacted_rules);
                shown(counts.map(|(median, most)| format!("{median:.0}, {most}")))
            }),
            ("failed", &|(_, one)| one.failed.to_string()),
        ],
    );
    let none_erred = summaries
        .iter()
        .all(|one| one.observation_error_share.is_none() && one.mislocalised_share.is_none());
    let all_can_solve = summaries.iter().all(|one| !one.needs_memory);
    let none_drove = summaries.iter().all(|one| one.driven_goals.is_none());
    table.without_dull(|name| match name {
        "memory" => all_can_solve,
        "obs. errors" | "mislocalised" => none_erred,
        "driven" | "driven: 95 %" | "shortest" | "driven steps" => none_drove,
        _ => ["arena", "sensor", "variant", "compacted", "failed"].contains(&name),
    })
}

/// Formats a value, or a dash if there is none.
pub fn shown(value: Option<impl ToString>) -> String {
    value.map_or("–".to_owned(), |value| value.to_string())
}

/// Formats a mean without decimals.
fn whole(mean: Option<f64>) -> String {
    shown(mean.map(|mean| format!("{mean:.0}")))
}

/// Formats a share in thousandths.
fn per_mille(share: Option<f64>) -> String {
    shown(share.map(|share| format!("{:.2} ‰", 1000.0 * share)))
}

/// Formats a share in percent.
fn percent(share: Option<f64>) -> String {
    shown(share.map(|share| format!("{:.0} %", 100.0 * share)))
}

/// Formats two shares as a range in percent.
fn percents(limits: Option<(f64, f64)>) -> String {
    shown(limits.map(|(low, high)| format!("{:.0}–{:.0} %", 100.0 * low, 100.0 * high)))
}

/// Describes what the numbers of the table cannot show.
pub fn limits(arms: &[ArmSummary], episodes: u32) -> String {
    let failed: usize = arms.iter().map(|arm| arm.failed).sum();
    let failed = match failed {
        0 => String::new(),
        _ => format!(" {failed} trials failed and are not counted: see `trials.csv`."),
    };
    let hopeless = match arms.iter().any(|arm| arm.needs_memory) {
        true => {
            " Where the column `memory` says `needed`, cells share a percept and need different actions, \
             so no policy without memory is optimal. More episodes cannot change that, and these rows \
             are in no test."
        }
        false => "",
    };
    let lost: u64 = arms
        .iter()
        .map(|arm| arm.successes.saturating_sub(arm.retained))
        .sum();
    let found: u64 = arms.iter().map(|arm| arm.successes).sum();
    let retained = match found {
        0 => String::new(),
        _ => format!(
            " Of the {found} trials that found an optimal policy, {lost} no longer had one after \
             their last episode."
        ),
    };
    format!(
        "These numbers hold for these worlds, percepts and settings, and for {episodes} episodes.\
         {hopeless}{retained}{failed}"
    )
}
