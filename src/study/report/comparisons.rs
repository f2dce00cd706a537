//! Which methods and variants differ, and which comparisons the data cannot decide.

use serde::Serialize;

use crate::agent::Method;
use crate::page::Table;
use crate::study::analysis::summary::{ArmRecords, rounded};
use crate::study::protocol::{Arm, NOTHING};
use crate::study::statistics::{Interval, fisher_exact, holm, log_rank, trials_needed};

/// Errors of the first kind that are accepted.
const ALPHA: f64 = 0.05;

/// One method, or one way of learning, against another in one world.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// The world.
    pub world: String,
    /// Arena, sensor and what is varied otherwise.
    pub setting: String,
    /// The first method, with its variant where variants are compared.
    pub method: String,
    /// The method, or the variant, that it is compared with.
    pub against: String,
    /// How much larger the first one's share of successes is, with its 95 % interval.
    pub difference: Interval,
    /// Fisher's exact p that the shares are equal.
    pub fisher_p: f64,
    /// The same after Holm's correction over the worlds.
    pub holm_p: f64,
    /// The log-rank p that both find their first optimum equally soon, in episodes.
    pub log_rank_p: f64,
    /// The same in steps in the environment, after Holm's correction over the worlds.
    pub steps_holm_p: f64,
    /// Trials of each that would tell such shares apart with a chance of 80 %.
    pub trials_needed: Option<u64>,
}

/// The keys of a variant of which each value is compared with [`NOTHING`].
const AGAINST_NOTHING: [&str; 2] = ["after", "without"];

impl Comparison {
    /// Can the data decide which has the larger share of successes?
    pub fn decides_share(&self) -> bool {
        self.holm_p < ALPHA
    }

    /// Can the data decide which needs fewer steps to its first optimum?
    pub fn decides_steps(&self) -> bool {
        self.steps_holm_p < ALPHA
    }

    /// `xcscr-plus` (or else `xcscr`, or the last method) against each other method, and learning
    /// `after` or `without` something against doing so after or without nothing; in each world.
    pub fn all(arms: &[ArmRecords<'_>]) -> Vec<Self> {
        let mut families: Vec<(Family, Vec<Self>)> = Vec::new();
        for (one, other, family) in pairs(arms) {
            let comparison = Self::new(one, other, &family);
            match families.iter_mut().find(|(known, _)| *known == family) {
                Some((_, members)) => members.push(comparison),
                None => families.push((family, vec![comparison])),
            }
        }
        let corrected = |(_, members)| Self::corrected(members);
        families.into_iter().flat_map(corrected).collect()
    }

    /// Comparisons in several worlds that together answer one question.
    fn corrected(mut members: Vec<Self>) -> Vec<Self> {
        let fisher: Vec<f64> = members.iter().map(|one| one.fisher_p).collect();
        let steps: Vec<f64> = members.iter().map(|one| one.steps_holm_p).collect();
        let corrected = holm(&fisher).into_iter().zip(holm(&steps));
        for (one, (holm_p, steps_holm_p)) in members.iter_mut().zip(corrected) {
            one.fisher_p = rounded(one.fisher_p);
            one.holm_p = rounded(holm_p);
            one.steps_holm_p = rounded(steps_holm_p);
        }
        members
    }

    fn new(a: &ArmRecords<'_>, b: &ArmRecords<'_>, family: &Family) -> Self {
        let (ours, theirs) = (a.successes(), b.successes());
        let difference = ours.difference(theirs);
        let [method, against, setting] = family.clone();
        Self {
            world: a.arm.world.clone(),
            setting,
            method,
            against,
            difference: Interval {
                value: rounded(difference.value),
                low: rounded(difference.low),
                high: rounded(difference.high),
            },
            fisher_p: fisher_exact(ours, theirs),
            holm_p: 1.0,
            log_rank_p: rounded(log_rank(&a.lifetimes(), &b.lifetimes())),
            steps_holm_p: log_rank(&a.step_lifetimes(), &b.step_lifetimes()),
            trials_needed: trials_needed(ours.share(), theirs.share()),
        }
    }
}

/// What is compared, with what, and what they have in common.
type Family = [String; 3];

/// Two arms, and the family to which their comparison belongs.
type Pair<'a> = (&'a ArmRecords<'a>, &'a ArmRecords<'a>, Family);

/// All pairs of arms that are to be compared.
fn pairs<'a>(arms: &'a [ArmRecords<'a>]) -> Vec<Pair<'a>> {
    let best = best_method(arms);
    let methods = arms.iter().filter_map(|other| {
        let is_rival = |one: &&ArmRecords<'_>| {
            Some(one.arm.method) == best
                && one.arm.world == other.arm.world
                && setting(one.arm, "") == setting(other.arm, "")
        };
        let one = arms.iter().find(is_rival)?;
        let [ours, theirs] = [one, other].map(|records| records.arm.method);
        let family = [
            ours.name().to_owned(),
            theirs.name().to_owned(),
            setting(one.arm, ""),
        ];
        (ours != theirs).then_some((one, other, family))
    });
    let variants = AGAINST_NOTHING.iter().flat_map(|key| {
        arms.iter().filter_map(move |one| {
            let value = value(one.arm, key).filter(|value| *value != NOTHING)?;
            let is_control = |other: &&ArmRecords<'_>| {
                value_is_nothing(other.arm, key)
                    && (&other.arm.world, other.arm.method) == (&one.arm.world, one.arm.method)
                    && setting(other.arm, key) == setting(one.arm, key)
            };
            let control = arms.iter().find(is_control)?;
            let ours = format!("{} {key} {value}", one.arm.method.name());
            let family = [ours, format!("{key} {NOTHING}"), setting(one.arm, key)];
            Some((one, control, family))
        })
    });
    methods.chain(variants).collect()
}

/// The method that is compared with all others.
fn best_method(arms: &[ArmRecords<'_>]) -> Option<Method> {
    let methods: Vec<Method> = arms.iter().map(|one| one.arm.method).collect();
    let ours = [Method::XcscrPlus, Method::Xcscr];
    let best = ours.into_iter().find(|method| methods.contains(method));
    best.or(methods.last().copied())
}

fn value<'a>(arm: &'a Arm, key: &str) -> Option<&'a str> {
    arm.variant.0.get(key)?.as_str()
}

fn value_is_nothing(arm: &Arm, key: &str) -> bool {
    value(arm, key) == Some(NOTHING)
}

/// Arena, sensor and all that is varied but `key`.
fn setting(arm: &Arm, key: &str) -> String {
    let mut variant = arm.variant.clone();
    variant.0.remove(key);
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
        "steps: Holm p",
        "decided",
        "trials needed",
    ]);
    table.rows = comparisons.iter().map(row).collect();
    table.without_dull(|name| name == "setting")
}

fn row(one: &Comparison) -> Vec<String> {
    let decided = match (one.decides_share(), one.decides_steps()) {
        (true, true) => "share, steps",
        (true, false) => "share",
        (false, true) => "steps",
        (false, false) => "no",
    };
    let trials = one.trials_needed.map(|trials| trials.to_string());
    vec![
        one.world.clone(),
        one.setting.clone(),
        format!("{} − {}", one.method, one.against),
        points(one.difference.value),
        points_range(one.difference),
        p_value(one.fisher_p),
        p_value(one.holm_p),
        p_value(one.log_rank_p),
        p_value(one.steps_holm_p),
        decided.to_owned(),
        trials.unwrap_or("–".to_owned()),
    ]
}

/// What the columns mean.
pub const LEGEND: &str = "points: how much larger the share of optimal trials is, with Fisher's \
    exact p. log-rank p: that both find the first optimum equally soon, in episodes; steps: the \
    same in environment steps. Holm: corrected over the worlds. trials needed: of each, to tell \
    such shares apart with a chance of 80 %.";

/// How many comparisons are decided, in a sentence.
pub fn decided(comparisons: &[Comparison]) -> String {
    let count =
        |decides: fn(&Comparison) -> bool| comparisons.iter().filter(|one| decides(one)).count();
    let number = match comparisons.len() {
        1 => "Of 1 comparison".to_owned(),
        number => format!("Of {number} comparisons"),
    };
    format!(
        "{number}, the data decide {} by the share of optimal trials and {} by the steps to \
         the first optimum, at the 5 % level.",
        count(Comparison::decides_share),
        count(Comparison::decides_steps)
    )
}

/// Which comparisons the data cannot decide; nothing if there are none.
pub fn undecided(comparisons: &[Comparison]) -> Option<String> {
    let open = comparisons
        .iter()
        .filter(|one| !one.decides_share() && !one.decides_steps());
    let words = open.map(|one| {
        let (world, method, against) = (&one.world, &one.method, &one.against);
        let [share, steps] = [one.holm_p, one.steps_holm_p].map(p_value);
        format!("{method} against {against} in {world} (p = {share}, {steps})").replace("= <", "<")
    });
    let words: Vec<String> = words.collect();
    (!words.is_empty()).then(|| {
        format!(
            "Neither the share of optimal trials nor the steps tell apart: {}.",
            words.join("; ")
        )
    })
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
