//! Analysis of the trials of a study, by arm.

pub(super) mod learning;
mod memoryless;
pub(super) mod summary;
pub(super) mod tables;
