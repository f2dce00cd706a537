//! The settings of a study that are not the defaults.

use toml::{Table, Value};

use crate::study::protocol::Arm;
use crate::study::trial::{Settings, flatten};

/// Which settings differ from the defaults, in sentences.
pub fn sentences(arms: &[Arm]) -> String {
    let mut methods: Vec<(&str, Vec<String>)> = Vec::new();
    for arm in arms {
        if methods.iter().all(|(name, _)| *name != arm.method.name()) {
            methods.push((arm.method.name(), changed(arm)));
        }
    }
    let lists: Vec<&Vec<String>> = methods.iter().map(|(_, list)| list).collect();
    let is_common = lists.windows(2).all(|pair| pair[0] == pair[1]);
    match lists.first() {
        Some(list) if is_common => format!("Settings: {}.", words(list)),
        _ => {
            let each = methods
                .iter()
                .map(|(name, list)| format!("{name}: {}.", words(list)));
            format!("Settings. {}", each.collect::<Vec<_>>().join(" "))
        }
    }
}

fn words(list: &[String]) -> String {
    match list.len() {
        0 => "the defaults".to_owned(),
        _ => format!("the defaults, but {}", list.join(", ")),
    }
}

/// The settings of an arm that are neither defaults nor swept.
fn changed(arm: &Arm) -> Vec<String> {
    let table = |settings: &Settings| -> Vec<(String, Value)> {
        flatten(Table::try_from(settings).expect("settings are plain data"))
    };
    let pairs = table(&arm.settings)
        .into_iter()
        .zip(table(&Settings::default()));
    pairs
        .filter(|((key, value), (_, default))| value != default && !arm.variant.0.contains_key(key))
        .map(|((key, value), (_, default))| format!("`{key}` = {value} (default {default})"))
        .collect()
}
