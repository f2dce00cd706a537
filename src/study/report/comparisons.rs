//! Which methods differ, and which comparisons the data cannot decide.

use serde::Serialize;

use super::document::Table;
use crate::reward::Method;
use crate::study::statistics::{Interval, Proportion, fisher_exact, holm, log_rank, trials_needed};
use crate::study::summary::{ArmRecords, rounded};

/// Errors of the first kind that are accepted.
const ALPHA: f64 = 0.05;

/// One method against another in one world.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// The world.
    pub world: String,
    /// Arena, sensor and swept settings.
    pub setting: String,
    /// The first method.
    pub method: &'static str,
    /// The method that it is compared with.
    pub against: &'static str,
    /// How much larger the first one's share of successes is, with its 95 % interval.
    pub difference: Interval,
    /// Fisher's exact p.
    pub fisher_p: f64,
    /// The same after Holm's correction over the worlds.
    pub holm_p: f64,
    /// The log-rank p that both find their first optimum equally soon.
    pub log_rank_p: f64,
    /// Trials per method that would tell such a difference apart with a chance of 80 %.
    pub trials_needed: Option<u64>,
}

impl Comparison {
    /// Can the data decide which of the two is better?
    pub fn is_decided(&self) -> bool {
        self.holm_p < ALPHA
    }

    /// `xcscr-plus` (or else `xcscr`, or the last method) against each other method, in each world.
    pub fn all(arms: &[ArmRecords<'_>]) -> Vec<Self> {
        let mut methods: Vec<Method> = arms.iter().map(|one| one.arm.method).collect();
        methods.dedup();
        let ours = [Method::XcscrPlus, Method::Xcscr];
        let best = ours.iter().find(|method| methods.contains(method));
        let Some(best) = best.or(methods.last()).copied() else {
            return Vec::new();
        };
        let mut families: Vec<(Method, String)> = Vec::new();
        for one in arms.iter().filter(|one| one.arm.method != best) {
            let family = (one.arm.method, setting(one));
            if !families.contains(&family) {
                families.push(family);
            }
        }
        let family =
            |(other, setting): &(Method, String)| Self::family(arms, best, *other, setting);
        families.iter().flat_map(family).collect()
    }

    /// Two methods in all worlds: together they answer one question.
    fn family(arms: &[ArmRecords<'_>], best: Method, other: Method, of: &str) -> Vec<Self> {
        let all = |method| {
            arms.iter()
                .filter(move |one| one.arm.method == method && setting(one) == of)
        };
        let pairs = all(best).filter_map(|a| {
            let b = all(other).find(|b| b.arm.world == a.arm.world)?;
            Some(Self::new(a, b))
        });
        let mut pairs: Vec<Self> = pairs.collect();
        let ps: Vec<f64> = pairs.iter().map(|pair| pair.fisher_p).collect();
        for (pair, p) in pairs.iter_mut().zip(holm(&ps)) {
            pair.holm_p = rounded(p);
            pair.fisher_p = rounded(pair.fisher_p);
        }
        pairs
    }

    fn new(a: &ArmRecords<'_>, b: &ArmRecords<'_>) -> Self {
        let (ours, theirs) = (a.successes(), b.successes());
        let difference = ours.difference(theirs);
        Self {
            world: a.arm.world.clone(),
            setting: setting(a),
            method: a.arm.method.name(),
            against: b.arm.method.name(),
            difference: Interval {
                value: rounded(difference.value),
                low: rounded(difference.low),
                high: rounded(difference.high),
            },
            fisher_p: fisher_exact(ours, theirs),
            holm_p: 1.0,
            log_rank_p: rounded(log_rank(&a.lifetimes(), &b.lifetimes())),
            trials_needed: trials_needed(ours.share(), theirs.share()),
        }
    }
}

fn setting(records: &ArmRecords<'_>) -> String {
    let arm = records.arm;
    let variant = arm.variant.to_string();
    format!("{}, {} {variant}", arm.arena.name(), arm.sensor.name())
        .trim_end()
        .to_owned()
}

/// The comparisons as a table.
pub fn table(comparisons: &[Comparison]) -> Table {
    let mut table = Table::new([
        "world",
        "setting",
        "comparison",
        "points",
        "95 % interval",
        "Fisher p",
        "Holm p",
        "log-rank p",
        "decided",
        "trials needed",
    ]);
    table.rows = comparisons
        .iter()
        .map(|one| {
            vec![
                one.world.clone(),
                one.setting.clone(),
                format!("{} − {}", one.method, one.against),
                points(one.difference.value),
                points_range(one.difference),
                p_value(one.fisher_p),
                p_value(one.holm_p),
                p_value(one.log_rank_p),
                if one.is_decided() { "yes" } else { "no" }.to_owned(),
                one.trials_needed
                    .map_or("–".to_owned(), |trials| trials.to_string()),
            ]
        })
        .collect();
    table.without_dull(|name| name == "setting")
}

/// What the comparisons mean, in a sentence.
pub fn verdict(comparisons: &[Comparison]) -> String {
    let undecided: Vec<String> = comparisons
        .iter()
        .filter(|one| !one.is_decided())
        .map(|one| {
            let (world, method, against) = (&one.world, one.method, one.against);
            let p = p_value(one.holm_p);
            format!("{method} against {against} in {world} (p = {p})").replace("= <", "<")
        })
        .collect();
    let decided = comparisons.len() - undecided.len();
    let all = comparisons.len();
    match undecided.len() {
        0 => format!("The data decide all {all} comparisons at the 5 % level."),
        _ => format!(
            "The data decide {decided} of {all} comparisons at the 5 % level. They cannot decide {}.",
            undecided.join("; ")
        ),
    }
}

/// What can be said of the paper's own closest result.
pub fn paper_maze4() -> String {
    let of_100 = |successes| Proportion {
        successes,
        trials: 100,
    };
    let p = p_value(fisher_exact(of_100(79), of_100(77)));
    let needed = trials_needed(0.79, 0.77).unwrap_or(0);
    format!(
        "The paper's own 79 against 77 of 100 in Maze4 cannot be decided either: p = {p}; it would \
         take {needed} trials of each method."
    )
}

/// A p-value to four decimals.
pub fn p_value(p: f64) -> String {
    if p < 0.0001 {
        "< 0.0001".to_owned()
    } else {
        format!("{p:.4}")
    }
}

/// A difference of shares in percentage points.
pub fn points(difference: f64) -> String {
    format!("{:+.0}", 100.0 * difference)
}

/// The interval of a difference in percentage points.
pub fn points_range(difference: Interval) -> String {
    let (low, high) = (100.0 * difference.low, 100.0 * difference.high);
    format!("{low:+.1} to {high:+.1}")
}
