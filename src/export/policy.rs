//! The exported policy.

use super::maps::MapTable;
use super::quantised::{ExportError, QuantisedPolicy};
use crate::agent::Knowledge;
use xcs::Percept;

/// Rules that vote, and the maps of rules with a map.
#[derive(Debug, Clone, PartialEq)]
pub struct Policy {
    quantised: QuantisedPolicy,
    maps: Option<MapTable>,
}

impl Policy {
    /// Quantises a policy learned on percepts of `width` bits and `actions` actions. Compares the
    /// result as described in [`QuantisedPolicy::new`].
    ///
    /// # Errors
    /// When there is nothing to export, or the policy cannot be expressed exactly.
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

    /// The maps, if the rules use any.
    pub(super) fn maps(&self) -> Option<&MapTable> {
        self.maps.as_ref()
    }
}
