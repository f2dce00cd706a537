//! What is exported.

use super::ballot::{Ballot, ExportError};
use super::memory::Charts;
use crate::agent::Knowledge;
use xcs::Percept;

/// Rules that vote; with a memory the charts that they go by.
#[derive(Debug, Clone, PartialEq)]
pub struct Policy {
    ballot: Ballot,
    charts: Option<Charts>,
}

impl Policy {
    /// The policy of what was learned about percepts of `width` bits and `actions` actions, compared
    /// as [`Ballot::new`] says.
    ///
    /// # Errors
    /// When there is nothing to export, or it cannot be expressed exactly.
    pub fn new(
        knowledge: &Knowledge,
        width: usize,
        actions: usize,
        of_world: &[Percept],
    ) -> Result<Self, ExportError> {
        let charts = match knowledge {
            Knowledge::Remembering { map, .. } => Some(Charts::new(map)?),
            _ => None,
        };
        Ok(Self {
            ballot: Ballot::new(knowledge, width, actions, of_world)?,
            charts,
        })
    }

    /// The rules.
    pub fn ballot(&self) -> &Ballot {
        &self.ballot
    }

    /// The charts, if the rules go by any.
    pub(super) fn charts(&self) -> Option<&Charts> {
        self.charts.as_ref()
    }
}
