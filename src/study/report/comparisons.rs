//! Statistical comparisons of methods and variants, and those that remain undecided.

use serde::Serialize;

use super::results::shown;
use crate::arena::ArenaKind;
use crate::page::Table;
use crate::sensor::Sensor;
use crate::study::analysis::summary::{ArmRecords, by_score, by_steps, by_success};
use crate::study::protocol::{Arm, NOTHING};
use crate::study::statistics::{ALPHA, Interval, Pairs, SignTest, holm, rounded};
use crate::trial::flatten;

/// The comparison of one method, or variant, with another in one world.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// The world.
    pub world: String,
    /// Arena, sensor and the other varied settings.
    pub setting: String,
    /// The first method, with its variant if variants are compared.
    pub method: String,
    /// The second method, or variant.
    pub against: String,
    /// Share of successes of the first minus that of the second, with its 95 % interval.
    pub difference: Interval,
    /// McNemar's exact p that the shares are equal, over the pairs of trials with the same seed.
    pub mcnemar_p: f64,
    /// `mcnemar_p` after Holm's correction over all worlds and methods that are compared.
    pub holm_p: f64,
    /// Number of pairs in which the first needed fewer steps to its first optimum. The trials of a
    /// pair have the same seed. A trial without an optimum counts as later than any with one.
    pub sooner: u64,
    /// Number of pairs in which the first needed more steps.
    pub later: u64,
    /// The sign test's exact p that either is sooner equally often, after Holm's correction over
    /// all worlds and methods that are compared.
    pub steps_holm_p: f64,
    /// Number of pairs in which the greedy policy of the first has a higher score at the end.
    pub higher: u64,
    /// Number of pairs in which it has a lower score.
    pub lower: u64,
    /// The sign test's exact p that either is higher equally often, after Holm's correction.
    pub score_holm_p: f64,
    /// Trials of each with which McNemar's test, corrected for the number of comparisons, would decide such shares with
    /// a power of 80 %.
    pub trials_needed: Option<u64>,
    /// The number of comparisons for which Holm's correction accounts.
    #[serde(skip)]
    pub corrected_for: usize,
    /// The pairs by which of the two had the optimal trial.
    #[serde(skip)]
    successes: Pairs,
}

/// Maximum number of swept combinations to compare. More are a search.
const MOST_VALUES: usize = 24;

/// The key of a variant whose values are each compared with [`NOTHING`].
const WITHOUT: &str = "without";

impl Comparison {
    /// Returns true if the data decide which has the larger share of successes.
    pub fn decides_share(&self) -> bool {
        self.holm_p < ALPHA
    }

    /// Returns true if the data decide which needs fewer steps to its first optimum.
    pub fn decides_steps(&self) -> bool {
        self.steps_holm_p < ALPHA
    }

    /// Returns true if the data decide which has the higher scores.
    pub fn decides_score(&self) -> bool {
        self.score_holm_p < ALPHA
    }

    /// Returns all comparisons in each world. The method `reference` is compared with each other
    /// method. Each value of `without` is compared with nothing. Each value of a swept setting is compared with the first one. The arms of a comparison differ in
    /// nothing else.
    pub fn all(arms: &[ArmRecords<'_>], reference: &str) -> Vec<Self> {
        let mut families: Vec<(String, Vec<Self>)> = Vec::new();
        for pair in pairs(arms, reference) {
            let comparison = Self::new(&pair);
            match families
                .iter_mut()
                .find(|(family, _)| *family == pair.family)
            {
                Some((_, members)) => members.push(comparison),
                None => families.push((pair.family, vec![comparison])),
            }
        }
        let corrected = |(_, members)| Self::corrected(members);
        families.into_iter().flat_map(corrected).collect()
    }

    /// Applies Holm's correction to comparisons that answer one question.
    fn corrected(mut members: Vec<Self>) -> Vec<Self> {
        let corrected = |p: fn(&Self) -> f64| holm(&members.iter().map(p).collect::<Vec<_>>());
        let shares = corrected(|one| one.mcnemar_p);
        let steps = corrected(|one| one.steps_holm_p);
        let scores = corrected(|one| one.score_holm_p);
        let corrected_for = members.len();
        for (at, one) in members.iter_mut().enumerate() {
            one.mcnemar_p = rounded(one.mcnemar_p);
            one.holm_p = rounded(shares[at]);
            one.steps_holm_p = rounded(steps[at]);
            one.score_holm_p = rounded(scores[at]);
            one.corrected_for = corrected_for;
            one.trials_needed = one.trials_needed();
        }
        members
    }

    fn new(pair: &Pair<'_>) -> Self {
        let (a, b) = (pair.one, pair.other);
        let (successes, steps) = (a.pairs(b, by_success), a.pairs(b, by_steps));
        let scores = a.pairs(b, by_score);
        let [method, against, setting] = pair.names.clone();
        Self {
            world: a.arm.world.clone(),
            setting,
            method,
            against,
            difference: successes.difference().rounded(),
            mcnemar_p: successes.p(),
            holm_p: 1.0,
            sooner: steps.better,
            later: steps.worse,
            steps_holm_p: steps.p(),
            higher: scores.better,
            lower: scores.worse,
            score_holm_p: scores.p(),
            trials_needed: None,
            corrected_for: 1,
            successes,
        }
    }

    fn trials_needed(&self) -> Option<u64> {
        let count = self.successes.count().max(1) as f64;
        let [better, worse] =
            [self.successes.better, self.successes.worse].map(|pairs| pairs as f64 / count);
        SignTest::of(self.corrected_for).pairs_needed(better, worse)
    }
}

/// Two arms to compare.
struct Pair<'a> {
    one: &'a ArmRecords<'a>,
    other: &'a ArmRecords<'a>,
    /// The first, the second, and what they have in common.
    names: [String; 3],
    /// The comparisons of a family together answer one question.
    family: String,
}

impl<'a> Pair<'a> {
    /// Creates a pair in the family of all pairs of this kind in one arena with one percept: in all
    /// worlds, and under all settings that vary.
    fn new(
        kind: &str,
        one: &'a ArmRecords<'a>,
        other: &'a ArmRecords<'a>,
        names: [String; 3],
    ) -> Self {
        Self {
            one,
            other,
            family: format!("{kind} {} {}", one.arm.arena.name(), one.arm.sensor.name()),
            names,
        }
    }
}

/// Returns all pairs of arms to compare.
fn pairs<'a>(arms: &'a [ArmRecords<'a>], reference: &str) -> Vec<Pair<'a>> {
    let mut pairs = pairs_of_methods(arms, reference);
    pairs.extend(pairs_without(arms));
    pairs.extend(pairs_of_values(arms));
    pairs
}

/// Pairs the reference method with each other one, in each world. A family spans all worlds and
/// methods.
fn pairs_of_methods<'a>(arms: &'a [ArmRecords<'a>], reference: &str) -> Vec<Pair<'a>> {
    let pair = |other: &'a ArmRecords<'a>| {
        let setting = setting(other.arm, "");
        let one = arms.iter().find(|one| {
            one.arm.method_name() == reference
                && one.arm.world == other.arm.world
                && self::setting(one.arm, "") == setting
        })?;
        let [ours, theirs] = [one, other].map(|records| records.arm.method_name().to_owned());
        (ours != theirs).then(|| Pair::new("methods", one, other, [ours, theirs, setting]))
    };
    arms.iter().filter_map(pair).collect()
}

/// Pairs each value of `without` with nothing. A family spans all worlds and values of a
/// method.
fn pairs_without<'a>(arms: &'a [ArmRecords<'a>]) -> Vec<Pair<'a>> {
    let key = WITHOUT;
    let pair = |one: &'a ArmRecords<'a>| {
        let value = value(one.arm, key).filter(|value| *value != NOTHING)?;
        let (method, setting) = (one.arm.method_name(), setting(one.arm, key));
        let other = arms.iter().find(|other| {
            self::value(other.arm, key) == Some(NOTHING)
                && other.arm.world == one.arm.world
                && other.arm.method_name() == method
                && self::setting(other.arm, key) == setting
        })?;
        let ours = format!("{method} {key} {value}");
        let names = [ours, format!("{key} {NOTHING}"), setting];
        Some(Pair::new(&format!("{method} {key}"), one, other, names))
    };
    arms.iter().filter_map(pair).collect()
}

/// Pairs each value of a swept setting with its first one, where everything else is the same. A family
/// spans all worlds and values of a method. Returns none for large searches
/// ([`of_searches`]).
fn pairs_of_values<'a>(arms: &'a [ArmRecords<'a>]) -> Vec<Pair<'a>> {
    let pair = |one: &'a ArmRecords<'a>, key: &String| {
        let (there, setting) = (place(one.arm), setting(one.arm, key));
        let same_place = || arms.iter().filter(|other| place(other.arm) == there);
        let differs_in_key = |other: &&ArmRecords<'_>| self::setting(other.arm, key) == setting;
        let other = same_place().find(differs_in_key)?;
        let [ours, theirs] = [one, other].map(|records| value_of(records.arm, key));
        if ours == theirs || same_place().count() > MOST_VALUES {
            return None;
        }
        let method = one.arm.method_name();
        let names = [format!("{method} {ours}"), theirs, setting];
        Some(Pair::new(&format!("values {method}"), one, other, names))
    };
    let is_swept = |key: &&String| *key != WITHOUT;
    let of_arm = |one: &'a ArmRecords<'a>| {
        let keys = one.arm.variant.0.keys().filter(is_swept);
        keys.filter_map(move |key| pair(one, key))
    };
    arms.iter().flat_map(of_arm).collect()
}

/// Returns world, method, arena and sensor.
fn place(arm: &Arm) -> (&str, &str, ArenaKind, Sensor) {
    (&arm.world, arm.method_name(), arm.arena, arm.sensor)
}

/// Returns a sentence about sweeps whose values are not compared; `None` without them.
pub fn of_searches(arms: &[Arm]) -> Option<String> {
    let is_search = |arm: &Arm| {
        let same = arms.iter().filter(|other| place(other) == place(arm));
        !arm.variant.0.is_empty() && same.count() > MOST_VALUES
    };
    arms.iter().any(is_search).then(|| {
        format!(
            "A sweep of more than {MOST_VALUES} combinations is a search. Its values are not compared: the best of \
             many looks better than it is. Test the best ones in a study with new seeds."
        )
    })
}

/// Returns a varied setting and its value, as in `xcs.beta=0.1`. Where another table of the sweep does not have the setting,
/// it is that of the study.
fn value_of(arm: &Arm, key: &str) -> String {
    let mut variant = arm.variant.clone();
    variant.0.retain(|other, _| other == key);
    if !variant.0.is_empty() {
        return variant.to_string();
    }
    let settings = toml::Table::try_from(&arm.settings).expect("settings are plain data");
    let own = flatten(settings).into_iter().find(|(name, _)| name == key);
    let value = own.map_or_else(String::new, |(_, value)| match value.as_str() {
        Some(text) => text.to_owned(),
        None => value.to_string(),
    });
    format!("{key}={value}")
}

fn value<'a>(arm: &'a Arm, key: &str) -> Option<&'a str> {
    arm.variant.0.get(key)?.as_str()
}

/// Returns arena, sensor and the varied settings except `key`.
fn setting(arm: &Arm, key: &str) -> String {
    let mut variant = arm.variant.clone();
    variant.0.remove(key);
    format!("{}, {} {variant}", arm.arena.name(), arm.sensor.name())
        .trim_end()
        .to_owned()
}

/// Formats the comparisons as a table, with letters for the names of swept settings.
pub fn table(comparisons: &[Comparison], letters: &[(String, String)]) -> Table {
    let short = |name: &str| {
        let names = letters.iter().filter(|_| letters.len() > 1);
        names.fold(name.to_owned(), |name, (letter, key)| {
            name.replace(&format!("{key}="), &format!("{letter}="))
        })
    };
    let table = Table::of(
        comparisons,
        &[
            ("world", &|one| one.world.clone()),
            ("setting", &|one| one.setting.clone()),
            ("comparison", &|one| {
                format!("{} − {}", short(&one.method), short(&one.against))
            }),
            ("points", &|one| points(one.difference.value)),
            ("95 % interval", &|one| points_range(one.difference)),
            ("McNemar p", &|one| p_value(one.mcnemar_p)),
            ("Holm p", &|one| p_value(one.holm_p)),
            ("sooner, later", &|one| {
                format!("{}, {}", one.sooner, one.later)
            }),
            ("steps: Holm p", &|one| p_value(one.steps_holm_p)),
            ("score: higher, lower", &|one| {
                format!("{}, {}", one.higher, one.lower)
            }),
            ("score: Holm p", &|one| p_value(one.score_holm_p)),
            ("decided", &|one| decided_outcomes(one)),
            ("trials needed", &|one| shown(one.trials_needed)),
        ],
    );
    table.without_dull(|name| name == "setting")
}

/// Lists the outcomes that the data decide.
fn decided_outcomes(one: &Comparison) -> String {
    let outcomes = [
        ("share", one.decides_share()),
        ("steps", one.decides_steps()),
        ("score", one.decides_score()),
    ];
    let decided = outcomes.iter().filter(|(_, decides)| *decides);
    let names: Vec<&str> = decided.map(|(name, _)| *name).collect();
    if names.is_empty() {
        "no".to_owned()
    } else {
        names.join(", ")
    }
}

/// The description of the columns.
pub const LEGEND: &str = "Trials with the same seed are pairs. points: how much larger the share of \
    optimal trials is, with McNemar's exact p. sooner, later: the number of pairs in which the first needed fewer or more \
    environment steps to its first optimum (a trial without one counts as later than any with one), \
    with the p of the sign test. score: the same for the scores of the final greedy policies. Holm: corrected over all worlds and methods (or parts left out, or values of a sweep) of one setting. \
    trials needed: trials of each with which McNemar's test would decide such shares with a power of 80 %, at the \
    strictest level of Holm's correction.";

/// Formats a p-value with four decimals.
pub fn p_value(p: f64) -> String {
    if p < 0.0001 {
        "< 0.0001".to_owned()
    } else {
        format!("{p:.4}")
    }
}

/// Formats a difference of shares in percentage points.
pub fn points(difference: f64) -> String {
    format!("{:+.0}", 100.0 * difference)
}

/// Formats the interval of a difference in percentage points.
pub fn points_range(difference: Interval) -> String {
    let (low, high) = (100.0 * difference.low, 100.0 * difference.high);
    format!("{low:+.1} to {high:+.1}")
}
