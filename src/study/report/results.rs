//! The table of results, with a row for each arm.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::page::Table;
use crate::study::analysis::summary::ArmSummary;
use crate::study::protocol::{Arm, Variant};

/// The row of an arm.
struct Row<'a> {
    arm: &'a Arm,
    letters: &'a [(String, String)],
    summary: &'a ArmSummary,
}

/// When a column is shown.
enum Shown {
    Always,
    /// If two rows differ in it.
    IfVaried,
    /// If a row has what it shows.
    If(fn(&ArmSummary) -> bool),
}

/// A column of the table of results.
struct Column {
    name: &'static str,
    /// The columns that are described with this one, and their description.
    about: Option<(&'static str, &'static str)>,
    shown: Shown,
    cell: fn(&Row<'_>) -> String,
}

impl Column {
    /// Returns a column that is always shown and says by its name what it is.
    const fn new(name: &'static str, cell: fn(&Row<'_>) -> String) -> Self {
        Self {
            name,
            about: None,
            shown: Shown::Always,
            cell,
        }
    }

    const fn about(self, names: &'static str, about: &'static str) -> Self {
        Self {
            about: Some((names, about)),
            ..self
        }
    }

    const fn shown(self, shown: Shown) -> Self {
        Self { shown, ..self }
    }
}

const HAS_MEMORY: Shown = Shown::If(|one| one.needs_memory);
const HAS_ERRED: Shown =
    Shown::If(|one| one.observation_error_share.is_some() || one.mislocalised_share.is_some());
const HAS_DRIVEN: Shown = Shown::If(|one| one.driven_goals.is_some());

/// The columns of the table of results, with their description in the report and in the reference.
static COLUMNS: [Column; 26] = [
    Column::new("world", |row| row.summary.world.clone()),
    Column::new("method", |row| row.summary.method.clone()),
    Column::new("arena", |row| row.summary.arena.to_owned()).shown(Shown::IfVaried),
    Column::new("sensor", |row| row.summary.sensor.to_owned()).shown(Shown::IfVaried),
    Column::new("variant", |row| variant(&row.arm.variant, row.letters)).shown(Shown::IfVaried),
    Column::new("memory", |row| {
        let word = if row.summary.needs_memory { "needed" } else { "–" };
        word.to_owned()
    })
    .shown(HAS_MEMORY)
    .about(
        "memory",
        "needed where no policy without memory is optimal, because cells share a percept.",
    ),
    Column::new("solved", |row| row.summary.successes.to_string()).about(
        "solved",
        "trials whose greedy policy became globally optimal, with Wilson's interval.",
    ),
    Column::new("of", |row| row.summary.trials.to_string()),
    Column::new("95 % interval", |row| {
        let limits = Some((row.summary.wilson_low, row.summary.wilson_high));
        percents(limits.filter(|_| row.summary.trials > 0))
    }),
    Column::new("retained", |row| row.summary.retained.to_string()).about(
        "retained",
        "trials whose policy is optimal after the last episode.",
    ),
    Column::new("stays optimal", |row| {
        percent(row.summary.mean_optimal_share_after_first)
    })
    .about(
        "stays optimal",
        "the mean share of episodes with an optimal policy, after the first one.",
    ),
    Column::new("median", |row| shown(row.summary.median_episode)).about(
        "median, p95",
        "the episode by which half, or 95 %, of all trials were optimal (– when they never were).",
    ),
    Column::new("p95", |row| shown(row.summary.p95_episode)),
    Column::new("steps (IQM)", |row| whole(row.summary.iqm_env_steps)).about(
        "steps",
        "environment steps until a trial is solved, interquartile mean with bootstrap interval; unsolved trials count \
         with all their steps.",
    ),
    Column::new("steps: 95 %", |row| {
        let (low, high) = (row.summary.iqm_env_steps_low, row.summary.iqm_env_steps_high);
        shown(low.zip(high).map(|(low, high)| format!("{low:.0}–{high:.0}")))
    }),
    Column::new("score", |row| {
        shown(row.summary.mean_greedy_score.map(|mean| format!("{mean:.2}")))
    })
    .about(
        "score",
        "of the final greedy policy, the mean share of starts from which it reaches a goal, times the optimum as a \
         share of its steps there.",
    ),
    Column::new("driven", |row| percent(row.summary.driven_goals))
        .shown(HAS_DRIVEN)
        .about(
            "driven",
            "after training, the greedy policy drives the trial's robot; the share of these drives that reach a goal, \
             and the 95 % interval of the share of trials whose drives all do.",
        ),
    Column::new("driven: 95 %", |row| {
        percents(row.summary.driven_always_low.zip(row.summary.driven_always_high))
    })
    .shown(HAS_DRIVEN),
    Column::new("shortest", |row| percent(row.summary.driven_optimal))
        .shown(HAS_DRIVEN)
        .about(
            "shortest",
            "drives along a shortest path (where moves slip: drives with best actions only).",
        ),
    Column::new("driven steps", |row| {
        shown(row.summary.driven_steps.map(|steps| format!("{steps:.1}")))
    })
    .shown(HAS_DRIVEN)
    .about("driven steps", "their mean steps."),
    Column::new("obs. errors", |row| per_mille(row.summary.observation_error_share))
        .shown(HAS_ERRED)
        .about(
            "obs. errors",
            "the share of steps whose percept differs from that of perfect sensors.",
        ),
    Column::new("mislocalised", |row| per_mille(row.summary.mislocalised_share))
        .shown(HAS_ERRED)
        .about(
            "mislocalised",
            "the share of steps after which the robot is in another cell than its estimate.",
        ),
    Column::new("collisions", |row| whole(row.summary.mean_collisions))
        .about("collisions", "mean of a trial."),
    Column::new("rules", |row| whole(row.summary.mean_rules)).about("rules", "mean of a trial."),
    Column::new("compacted", |row| {
        let counts = row.summary.median_compacted_rules;
        let counts = counts.zip(row.summary.most_compacted_rules);
        shown(counts.map(|(median, most)| format!("{median:.0}, {most}")))
    })
    .shown(Shown::IfVaried)
    .about(
        "compacted",
        "rules of retained trials after compaction, median and maximum.",
    ),
    Column::new("failed", |row| row.summary.failed.to_string()).shown(Shown::IfVaried),
];

/// Returns the described columns of the table of results: their names, and the description.
pub fn columns() -> impl Iterator<Item = (&'static str, &'static str)> {
    COLUMNS.iter().filter_map(|column| column.about)
}

/// Formats all arms and their summaries as a table.
pub fn table(arms: &[Arm], summaries: &[ArmSummary]) -> Table {
    let letters = letters(arms);
    let mut table = Table::new(COLUMNS.iter().map(|column| column.name));
    for (arm, summary) in arms.iter().zip(summaries) {
        let row = Row {
            arm,
            letters: &letters,
            summary,
        };
        let cells = COLUMNS.iter().map(|column| (column.cell)(&row));
        table.rows.push(cells.collect());
    }
    table.without_dull(|name| {
        let column = COLUMNS.iter().find(|column| column.name == name);
        match column.map(|column| &column.shown) {
            Some(Shown::IfVaried) => true,
            Some(Shown::If(has)) => !summaries.iter().any(has),
            Some(Shown::Always) | None => false,
        }
    })
}

/// Describes the columns of a table of results.
pub fn legend(table: &Table) -> String {
    let is_shown = |column: &&Column| table.header.iter().any(|name| *name == column.name);
    let about = COLUMNS
        .iter()
        .filter(is_shown)
        .filter_map(|column| column.about);
    let sentences: Vec<String> = about
        .map(|(names, about)| format!("{names}: {about}"))
        .collect();
    sentences.join(" ")
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
    let hopeless = if arms.iter().any(|arm| arm.needs_memory) {
        " Where the column `memory` says `needed`, cells share a percept and need different actions, \
             so no policy without memory is optimal. More episodes cannot change that, and these rows \
             are in no test."
    } else {
        ""
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
