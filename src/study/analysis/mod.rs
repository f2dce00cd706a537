//! What the trials of a study amount to, by arm.

pub(super) mod learning;
pub(super) mod summary;
pub(super) mod tables;
