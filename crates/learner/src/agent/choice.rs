//! Choices of actions, and their decision sources.

use std::fmt;

use serde::{Deserialize, Serialize};
use strum::{IntoStaticStr, VariantArray};
use xcs::Action;

/// The decision source of an action.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Hash,
    PartialOrd,
    Ord,
    Serialize,
    Deserialize,
    IntoStaticStr,
    VariantArray,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum DecisionSource {
    /// The rules of \[P\], by their prediction array.
    Rules,
    /// The table of a tabular method, or the plan of `r-max`.
    Table,
    /// An exploration plan.
    Planner,
    /// Chance: a random exploratory action, or nothing is known.
    Chance,
}

impl DecisionSource {
    /// Returns the name used in files.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

/// An action and its decision source.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Choice {
    /// The action.
    pub action: Action,
    /// The decision source.
    pub source: DecisionSource,
}

impl Choice {
    /// Creates a choice.
    pub fn new(action: Action, source: DecisionSource) -> Self {
        Self { action, source }
    }

    /// Creates a choice by `source`, or by chance if the step explores or no action has a value.
    pub fn by(source: DecisionSource, action: Action, by_chance: bool) -> Self {
        let source = if by_chance {
            DecisionSource::Chance
        } else {
            source
        };
        Self { action, source }
    }

    /// Returns true if the action was chosen to explore.
    pub fn explores(self) -> bool {
        matches!(
            self.source,
            DecisionSource::Planner | DecisionSource::Chance
        )
    }
}

/// The number of steps by decision source.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Chosen {
    /// Steps chosen by the rules of \[P\].
    pub rules: u64,
    /// Steps chosen by a table.
    pub table: u64,
    /// Steps chosen by an exploration plan.
    pub planner: u64,
    /// Steps chosen by chance.
    pub chance: u64,
}

impl Chosen {
    /// Counts one more step.
    pub fn count(&mut self, source: DecisionSource) {
        *match source {
            DecisionSource::Rules => &mut self.rules,
            DecisionSource::Table => &mut self.table,
            DecisionSource::Planner => &mut self.planner,
            DecisionSource::Chance => &mut self.chance,
        } += 1;
    }

    /// Adds the counts of `others`.
    pub fn add(&mut self, others: &Self) {
        self.rules += others.rules;
        self.table += others.table;
        self.planner += others.planner;
        self.chance += others.chance;
    }
}

impl fmt::Display for Chosen {
    /// Writes the sources with at least one step, each with its number of steps.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counts = [self.rules, self.table, self.planner, self.chance];
        let some = DecisionSource::VARIANTS.iter().zip(counts);
        let some = some.filter(|&(_, count)| count > 0);
        let words = some.map(|(source, count)| format!("{} {count}", source.name()));
        f.write_str(&words.collect::<Vec<_>>().join(", "))
    }
}
