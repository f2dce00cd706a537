//! The non-default settings of a study.

use std::collections::BTreeSet;

use toml::{Table, Value};

use crate::study::protocol::{Arm, Protocol, distinct};
use crate::trial::{FROM_MAZE, STEP_THRESHOLD, Settings, flatten};

/// Describes the settings that differ from the defaults, and where they differ, in sentences.
pub fn sentences(protocol: &Protocol) -> String {
    let arms = &protocol.arms;
    let lists: Vec<Vec<String>> = (0..arms.len()).map(|arm| changed(protocol, arm)).collect();
    let mut scopes: Vec<(String, Vec<&String>)> = vec![(String::new(), Vec::new())];
    let mut seen = BTreeSet::new();
    for item in lists.iter().flatten() {
        if !seen.insert(item) {
            continue;
        }
        let holds: Vec<bool> = lists.iter().map(|list| list.contains(item)).collect();
        let scope = scope(arms, &holds);
        match scopes.iter_mut().find(|(known, _)| *known == scope) {
            Some((_, items)) => items.push(item),
            None => scopes.push((scope, vec![item])),
        }
    }
    let words = scopes.iter().map(|(scope, items)| words(scope, items));
    format!("Settings: {}.", words.collect::<Vec<_>>().join("; "))
}

fn words(scope: &str, items: &[&String]) -> String {
    let items: Vec<&str> = items.iter().map(|item| item.as_str()).collect();
    let items = items.join(", ");
    match (scope.is_empty(), items.is_empty()) {
        (true, true) => "the defaults".to_owned(),
        (true, false) => format!("the defaults, except {items}"),
        (false, _) => format!("{scope}: {items}"),
    }
}

/// Returns the methods, worlds, variants or arms for which `holds` is true. Empty for all arms.
fn scope(arms: &[Arm], holds: &[bool]) -> String {
    if holds.iter().all(|holds| *holds) {
        return String::new();
    }
    let by = |name: &dyn Fn(&Arm) -> String| {
        let held = |one: &String| {
            let mut own = arms.iter().zip(holds).filter(|(arm, _)| name(arm) == *one);
            own.all(|(_, holds)| *holds)
        };
        let names = distinct(arms.iter().map(name)).into_iter();
        let names: Vec<String> = names.filter(held).collect();
        let covered = arms.iter().zip(holds);
        let whole = covered
            .filter(|(_, holds)| **holds)
            .all(|(arm, _)| names.contains(&name(arm)));
        whole.then(|| names.join(", "))
    };
    if let Some(methods) = by(&|arm| arm.method_name().to_owned()) {
        return format!("for {methods}");
    }
    if let Some(worlds) = by(&|arm| arm.world.clone()) {
        return format!("in {worlds}");
    }
    if let Some(variants) = by(&|arm| arm.variant.to_string()) {
        return format!("with {variants}");
    }
    let held = arms.iter().zip(holds).filter(|(_, holds)| **holds);
    let place = |arm: &Arm| match arm.variant.to_string() {
        empty if empty.is_empty() => format!("{} in {}", arm.method_name(), arm.world),
        variant => format!("{} in {} with {variant}", arm.method_name(), arm.world),
    };
    let places: BTreeSet<String> = held.map(|(arm, _)| place(arm)).collect();
    format!("for {}", Vec::from_iter(places).join(", "))
}

/// Returns the settings of an arm that are neither defaults nor swept, with those set by its maze.
fn changed(protocol: &Protocol, number: usize) -> Vec<String> {
    let arm = &protocol.arms[number];
    let table = |settings: &Settings| -> Vec<(String, Value)> {
        flatten(Table::try_from(settings).expect("settings are plain data"))
    };
    let without = arm.variant.0.get("without").and_then(|key| key.as_str());
    let is_varied = |key: &str| arm.variant.0.contains_key(key) || without == Some(key);
    let settled = protocol.plan(number * protocol.trials);
    let pairs = table(&settled.config.settings)
        .into_iter()
        .zip(table(&Settings::of(arm.method)));
    // The value of the step-threshold is printed with its origin.
    let is_listed = |key: &str| !is_varied(key) && key != FROM_MAZE;
    let origin = |key: &str, default| match settled.config.settings.reward.step_threshold_from_maze
    {
        true if key == STEP_THRESHOLD => "from the maze".to_owned(),
        _ => format!("default {default}"),
    };
    pairs
        .filter(|((key, value), (_, default))| value != default && is_listed(key))
        .map(|((key, value), (_, default))| {
            format!("`{key}` = {value} ({})", origin(&key, default))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::protocol::frozen;

    fn said(text: &str) -> String {
        let text = format!(
            "name = \"s\"\nworlds = [\"maze4\", \"maze5\"]\nmethods = [\"xcs\", \"adapted-even\"]\ntrials = 1\nepisodes = 1\n{text}"
        );
        sentences(&frozen(&text, &[]).unwrap())
    }

    #[test]
    fn a_step_threshold_is_reported_with_its_origin() {
        let set = said("[settings]\n\"reward.step_threshold\" = 60\n");
        let words = "Settings: the defaults; for xcs: `reward.step_threshold` = 60 (default 600); for adapted-even: \
             `reward.step_threshold` = 60 (default 50).";
        assert_eq!(set, words);
        let text = "name = \"s\"\nworlds = [\"maze4\", \"dfs-12-1\"]\nmethods = [\"q-learning\"]\ntrials = 1\nepisodes = 1\n";
        let told = sentences(&frozen(text, &[]).unwrap());
        let words = "in dfs-12-1: `reward.step_threshold` = 176 (from the maze)";
        assert!(told.contains(words), "{told}");
    }

    #[test]
    fn settings_are_reported_with_their_worlds_and_methods() {
        assert_eq!(said(""), "Settings: the defaults.");
        let text = "[settings]\n\"xcs.mu\" = 0.1\n[world-settings.maze5]\n\"xcs.chi\" = 0.5\n[method-settings.xcs]\n\"xcs.beta\" = 0.3\n";
        let told = said(text);
        for words in [
            "Settings: the defaults, except `xcs.mu` = 0.1 (default 0.01);",
            "; in maze5: `xcs.chi` = 0.5 (default 0.8)",
            "; for xcs: `xcs.beta` = 0.3 (default 0.2)",
        ] {
            assert!(told.contains(words), "{words} is missing in {told}");
        }
        let named = "[[sweep]]\nname = \"calm\"\n[[sweep]]\nname = \"greedy\"\nxcs.mu = 0.1\n";
        let words = "Settings: the defaults; with name=greedy: `xcs.mu` = 0.1 (default 0.01).";
        assert_eq!(said(named), words);
        let switched = said("without = [\"xcs.ga\"]\n");
        assert_eq!(switched, "Settings: the defaults.");
    }
}
