//! A table that is planned when it is asked for.

use std::sync::OnceLock;

use super::table::Table;
use crate::agent::model::planner::Problem;
use crate::agent::model::transitions::Transitions;

/// The value of an untried pair for a policy that is planned on what is known: below all others.
const UNTRIED: f64 = -1e9;

/// What is best by all that is known, and nothing else. It is planned on what was known when
/// this was made, however late that is: policies are asked for between episodes, and while no goal is
/// known, such a plan takes hundreds of sweeps.
#[derive(Debug, Clone)]
pub(super) struct Planned {
    problem: Problem,
    table: OnceLock<Table>,
}

impl Planned {
    pub fn on(problem: Problem) -> Self {
        let table = OnceLock::new();
        Self { problem, table }
    }

    /// The table; `memory` is that of the problem.
    pub fn table(&self, memory: &Transitions, actions: usize) -> &Table {
        let plan = || Table::from_values(memory, &self.problem.solve(UNTRIED), actions);
        self.table.get_or_init(plan)
    }
}

impl From<Table> for Planned {
    fn from(table: Table) -> Self {
        let problem = Problem::default();
        let table = table.into();
        Self { problem, table }
    }
}
