//! Analysis of the trials of a study, by arm.

pub(super) mod learning;
pub(super) mod summary;
pub(super) mod tables;
