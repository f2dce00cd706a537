//! Exports rules with a map: the maps as a table, and a tracker that localises the robot on them.

pub(super) mod c99;
mod maps;
mod demanded;
pub(super) mod python;
pub(super) mod rust;
mod usage;

pub(super) use maps::MapTable;
