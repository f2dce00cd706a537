//! The contribution of the switches that a study turns on and off.

use serde::Serialize;

use super::comparisons::{p_value, points, points_range};
use super::distinct;
use crate::page::Table;
use crate::study::analysis::summary::{ArmRecords, by_success};
use crate::study::protocol::Arm;
use crate::study::statistics::{Interval, Pairs, holm, rounded};

/// The effect of one switch in one world.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SwitchEffect {
    /// The world.
    pub world: String,
    /// Method, arena and sensor.
    pub setting: String,
    /// The name of the switch.
    pub switch: String,
    /// Share of successes with the switch minus the share without, over all states of the other
    /// switches. All three effects compare pairs of trials that differ in nothing but the switch.
    pub main_effect: Interval,
    /// The effect with all other switches on.
    pub last_added: Interval,
    /// The effect with all other switches off.
    pub alone: Interval,
    /// McNemar's exact p of `main_effect`, after Holm's correction over the switches. The trials of
    /// a pair differ in nothing but the switch.
    pub holm_p: f64,
}

/// Returns the varied settings that take both true and false in a study, and no other value.
pub fn switches(arms: &[ArmRecords<'_>]) -> Vec<String> {
    let Some(first) = arms.first() else {
        return Vec::new();
    };
    let takes = |key: &str, value: bool| arms.iter().any(|one| state(one.arm, key) == Some(value));
    let always = |key: &str| arms.iter().all(|one| state(one.arm, key).is_some());
    let keys = first.arm.variant.0.keys();
    keys.filter(|key| always(key) && takes(key, true) && takes(key, false))
        .cloned()
        .collect()
}

/// Returns the state of a switch in an arm, or `None` if the arm does not set it as a boolean.
pub fn state(arm: &Arm, switch: &str) -> Option<bool> {
    arm.variant.0.get(switch)?.as_bool()
}

/// The world, and method, arena and sensor: everything but the switches.
pub type Place = (String, String);

/// Returns the places of the arms, in the order of the study.
pub fn places(arms: &[ArmRecords<'_>]) -> Vec<Place> {
    distinct(arms.iter().map(|one| place(one.arm)))
}

/// Returns the place of an arm.
pub fn place(arm: &Arm) -> Place {
    let (method, arena) = (arm.method_name(), arm.arena.name());
    (
        arm.world.clone(),
        format!("{method}, {arena}, {}", arm.sensor.name()),
    )
}

impl SwitchEffect {
    /// Returns the effect of each switch in each place.
    pub fn all(arms: &[ArmRecords<'_>]) -> Vec<Self> {
        let switches = switches(arms);
        let in_place = |name: Place| {
            let own: Vec<&ArmRecords<'_>> =
                arms.iter().filter(|one| place(one.arm) == name).collect();
            Self::in_place(&name, &own, &switches)
        };
        places(arms).into_iter().flat_map(in_place).collect()
    }

    fn in_place(place: &Place, arms: &[&ArmRecords<'_>], switches: &[String]) -> Vec<Self> {
        let tests: Vec<f64> = switches
            .iter()
            .map(|switch| paired(arms, switch).p())
            .collect();
        let effect = |(switch, p): (&String, f64)| {
            let others = |on: bool| -> Vec<&ArmRecords<'_>> {
                let others = |one: &&&ArmRecords<'_>| {
                    let mut others = switches.iter().filter(|other| *other != switch);
                    others.all(|other| state(one.arm, other) == Some(on))
                };
                arms.iter().filter(others).copied().collect()
            };
            Self {
                world: place.0.clone(),
                setting: place.1.clone(),
                switch: switch.clone(),
                main_effect: paired(arms, switch).difference().rounded(),
                last_added: paired(&others(true), switch).difference().rounded(),
                alone: paired(&others(false), switch).difference().rounded(),
                holm_p: rounded(p),
            }
        };
        switches.iter().zip(holm(&tests)).map(effect).collect()
    }
}

/// Counts the pairs of trials with and without a switch. The trials of a pair have the same seed
/// and the same state of all other switches.
fn paired(arms: &[&ArmRecords<'_>], switch: &str) -> Pairs {
    let rest = |arm: &Arm| {
        let mut rest = arm.variant.clone();
        rest.0.remove(switch);
        rest
    };
    let with = arms
        .iter()
        .filter(|one| state(one.arm, switch) == Some(true));
    let without = |one: &ArmRecords<'_>| {
        let is_control = |other: &&&ArmRecords<'_>| {
            state(other.arm, switch) == Some(false) && rest(other.arm) == rest(one.arm)
        };
        arms.iter().find(is_control)
    };
    let pairs = with.filter_map(|one| Some(one.pairs(without(one)?, by_success)));
    pairs.fold(Pairs::default(), |sum, one| Pairs {
        better: sum.better + one.better,
        worse: sum.worse + one.worse,
        equal: sum.equal + one.equal,
    })
}

/// Formats the effects as a table, in percentage points.
pub fn table(effects: &[SwitchEffect]) -> Table {
    let table = Table::of(
        effects,
        &[
            ("world", &|one| one.world.clone()),
            ("setting", &|one| one.setting.clone()),
            ("switch", &|one| short(&one.switch)),
            ("main effect", &|one| points(one.main_effect.value)),
            ("95 % interval", &|one| points_range(one.main_effect)),
            ("Holm p", &|one| p_value(one.holm_p)),
            ("added last", &|one| points(one.last_added.value)),
            ("95 % interval ", &|one| points_range(one.last_added)),
            ("alone", &|one| points(one.alone.value)),
            ("95 % interval  ", &|one| points_range(one.alone)),
        ],
    );
    table.without_dull(|name| name == "setting")
}

/// Describes the effects in a sentence for each place.
pub fn verdict(effects: &[SwitchEffect]) -> String {
    let sentence = |effects: &[SwitchEffect]| {
        let words = |one: &SwitchEffect| {
            let unsure = if one.holm_p < 0.05 {
                ""
            } else {
                " (not distinguishable from 0)"
            };
            format!(
                "{} {}{unsure}",
                short(&one.switch),
                points(one.main_effect.value)
            )
        };
        let mut sorted: Vec<&SwitchEffect> = effects.iter().collect();
        sorted.sort_by(|a, b| b.main_effect.value.total_cmp(&a.main_effect.value));
        let words: Vec<String> = sorted.into_iter().map(words).collect();
        format!("{}: {}.", effects[0].world, words.join(", "))
    };
    let sentences: Vec<String> = effects
        .chunk_by(|a, b| (&a.world, &a.setting) == (&b.world, &b.setting))
        .map(sentence)
        .collect();
    format!(
        "Points that each switch adds to the share of successes, averaged over all settings of the \
         others. {}",
        sentences.join(" ")
    )
}

/// Returns the name of a setting in words, without its section.
pub fn short(switch: &str) -> String {
    let name = switch.rsplit('.').next().unwrap_or(switch);
    name.replace('_', " ")
}
