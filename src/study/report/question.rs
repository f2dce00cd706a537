//! The question of a study, in a sentence.

use std::collections::BTreeSet;

use super::distinct;
use crate::study::protocol::Arm;

/// Returns the question that the arms of a study answer.
pub fn question(arms: &[Arm]) -> String {
    let methods = distinct(arms.iter().map(|arm| arm.method_name().to_owned()));
    let worlds = distinct(arms.iter().map(|arm| arm.world.clone()));
    let (which, find, keep) = match methods.len() {
        1 => ("Does", "find", "does it keep"),
        _ => ("Which of", "finds", "which of them keeps"),
    };
    let varied: BTreeSet<String> = arms
        .iter()
        .flat_map(|arm| arm.variant.0.keys().cloned())
        .collect();
    let varied: Vec<String> = varied.iter().map(|key| format!("`{key}`")).collect();
    let varied = match varied.len() {
        0 => String::new(),
        _ => format!(" What is the effect of varying {}?", enumerated(&varied)),
    };
    format!(
        "{which} {} {find} a globally optimal policy in {}, how soon, and {keep} it to the end?{varied}",
        enumerated(&methods),
        enumerated(&worlds)
    )
}

fn enumerated(names: &[String]) -> String {
    match names {
        [] => String::new(),
        [only] => only.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}
