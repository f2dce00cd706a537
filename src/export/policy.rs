//! What is exported.

use super::memory::MapTable;
use super::quantised::{ExportError, QuantisedPolicy};
use crate::agent::Knowledge;
use xcs::Percept;

/// Rules that vote; with a memory the maps that they go by.
#[derive(Debug, Clone, PartialEq)]
pub struct Policy {
    quantised: QuantisedPolicy,
    maps: Option<MapTable>,
}

impl Policy {
    /// The policy of what was learned about percepts of `width` bits and `actions` actions, compared
    /// as [`QuantisedPolicy::new`] says.
    ///
    /// # Errors
    /// When there is nothing to export, or it cannot be expressed exactly.
    pub fn new(
        knowledge: &Knowledge,
        width: usize,
        actions: usize,
        of_world: &[Percept],
    ) -> Result<Self, ExportError> {
        let maps = match knowledge {
            Knowledge::Remembering { map, .. } => Some(MapTable::new(map)?),
            _ => None,
        };
        Ok(Self {
            quantised: QuantisedPolicy::new(knowledge, width, actions, of_world)?,
            maps,
        })
    }

    /// The rules.
    pub fn quantised(&self) -> &QuantisedPolicy {
        &self.quantised
    }

    /// The maps, if the rules go by any.
    pub(super) fn maps(&self) -> Option<&MapTable> {
        self.maps.as_ref()
    }
}
