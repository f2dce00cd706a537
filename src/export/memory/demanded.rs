//! Formats the condition of a rule as an expression of a programming language.

use crate::agent::{Demand, Part, demands};
use xcs::Condition;

/// The syntax of a language.
pub struct Language {
    /// The prefix of the name of a part.
    pub of: &'static str,
    /// The operator between demands.
    pub and: &'static str,
}

/// Returns the demands of a condition as an expression; `None` if the condition matches everything.
pub fn expression(condition: &Condition, language: &Language) -> Option<String> {
    let terms: Vec<String> = demands(condition)
        .into_iter()
        .map(|(part, demand)| term(&format!("{}{}", language.of, name(part)), demand))
        .collect();
    (!terms.is_empty()).then(|| terms.join(language.and))
}

fn term(part: &str, demand: Demand) -> String {
    match demand {
        Demand::Bits { care, value } => format!("({part} & {care:#06x}) == {value:#06x}"),
        Demand::Above(limit) => format!("{part} > {limit}"),
        Demand::AtMost(limit) => format!("{part} <= {limit}"),
    }
}

fn name(part: Part) -> &'static str {
    match part {
        Part::Percept => "percept",
        Part::X => "x",
        Part::Y => "y",
        Part::Map => "map",
        Part::Collected => "collected",
        Part::Last => "last",
        Part::Before => "before",
    }
}
