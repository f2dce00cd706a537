//! Who chose which action.

use std::fmt;

use serde::{Deserialize, Serialize};
use xcs::Action;
use xcs::bounds::{OutOfRange, within};

/// Who chose an action.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Chooser {
    /// The rules of \[P\], by their prediction array.
    Rules,
    /// The table of a tabular method, which may have been planned, or its plan on maps.
    Table,
    /// A plan, in order to explore.
    Planner,
    /// Chance: to explore, or because nothing was known.
    Chance,
}

impl Chooser {
    /// The name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rules => "rules",
            Self::Table => "table",
            Self::Planner => "planner",
            Self::Chance => "chance",
        }
    }
}

/// An action, and who chose it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Choice {
    /// The action.
    pub action: Action,
    /// Who chose it.
    pub chooser: Chooser,
}

impl Choice {
    /// A choice.
    pub fn new(action: Action, chooser: Chooser) -> Self {
        Self { action, chooser }
    }

    /// A choice of rules, unless it was left to chance: in order to explore, or because none matched.
    pub fn of_rules(action: Action, explores: bool) -> Self {
        let chooser = if explores {
            Chooser::Chance
        } else {
            Chooser::Rules
        };
        Self { action, chooser }
    }

    /// A choice of a table, unless it was left to chance: in order to explore, or for want of a row.
    pub fn of_a_table(action: Action, explores: bool) -> Self {
        let chooser = if explores {
            Chooser::Chance
        } else {
            Chooser::Table
        };
        Self { action, chooser }
    }

    /// Was it chosen to explore?
    pub fn explores(self) -> bool {
        matches!(self.chooser, Chooser::Planner | Chooser::Chance)
    }
}

/// How many steps each of them chose.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Chosen {
    /// The rules of \[P\].
    pub rules: u64,
    /// A table.
    pub table: u64,
    /// A plan.
    pub planner: u64,
    /// Chance.
    pub chance: u64,
}

impl Chosen {
    /// Counts one step more.
    pub fn count(&mut self, chooser: Chooser) {
        *match chooser {
            Chooser::Rules => &mut self.rules,
            Chooser::Table => &mut self.table,
            Chooser::Planner => &mut self.planner,
            Chooser::Chance => &mut self.chance,
        } += 1;
    }

    /// Counts all that others counted.
    pub fn add(&mut self, others: &Self) {
        self.rules += others.rules;
        self.table += others.table;
        self.planner += others.planner;
        self.chance += others.chance;
    }

    /// Accepts counts that can be those of `steps` steps.
    ///
    /// # Errors
    /// The first that cannot.
    pub fn check(&self, steps: u64) -> Result<(), OutOfRange> {
        within("chosen.rules", self.rules, 0..=steps)?;
        within("chosen.table", self.table, 0..=steps)?;
        within("chosen.planner", self.planner, 0..=steps)?;
        within("chosen.chance", self.chance, 0..=steps)
    }
}

impl fmt::Display for Chosen {
    /// Those that chose any, with their numbers.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let choosers = [
            Chooser::Rules,
            Chooser::Table,
            Chooser::Planner,
            Chooser::Chance,
        ];
        let counts = [self.rules, self.table, self.planner, self.chance];
        let some = choosers.iter().zip(counts).filter(|&(_, count)| count > 0);
        for (i, (chooser, count)) in some.enumerate() {
            let gap = if i == 0 { "" } else { ", " };
            write!(f, "{gap}{} {count}", chooser.name())?;
        }
        Ok(())
    }
}
