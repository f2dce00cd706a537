//! Rules with a memory: the maps that they go by as a table, and a tracker of where the robot is.

pub(super) mod c99;
mod maps;
mod demanded;
pub(super) mod python;
pub(super) mod rust;
mod usage;

pub(super) use maps::MapTable;
