//! What is exported.

use super::ballot::{Ballot, ExportError};
use super::filter::Filter;
use super::memory::Charts;
use crate::agent::Knowledge;
use xcs::Percept;

/// Rules that vote; with a memory the charts that they go by; where percepts are misread the filter of
/// these.
#[derive(Debug, Clone, PartialEq)]
pub struct Policy {
    ballot: Ballot,
    charts: Option<Charts>,
    filter: Option<Filter>,
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
        let (mut charts, mut filter) = (None, None);
        match knowledge {
            Knowledge::Remembering { map, .. } => charts = Some(Charts::new(map)?),
            Knowledge::Doubting { places, .. } => filter = Filter::new(places, width, actions)?,
            _ => {}
        }
        let mut percepts = of_world.to_vec();
        percepts.extend(filter.iter().flat_map(Filter::percepts));
        Ok(Self {
            ballot: Ballot::new(knowledge, width, actions, &percepts)?,
            charts,
            filter,
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

    /// The filter, if percepts were misread.
    pub(super) fn filter(&self) -> Option<&Filter> {
        self.filter.as_ref()
    }
}
