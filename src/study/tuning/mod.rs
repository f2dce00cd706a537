//! The search for settings: successive halving over seeds.
//!
//! All candidates start with few seeds. Each rung eliminates the worse half, and every candidate
//! that is significantly worse than the leader. The rest share the trials of the next rung. The
//! finalists are compared on seeds that the search did not use.
//!
//! Every rung is a [planned study](super::PlannedStudy). A search therefore runs wherever studies
//! run, and an interrupted search continues: the finished trials determine the next rung.

mod candidates;
mod search;
mod standing;

pub use search::{Found, Rung, Stage, Tuning};
pub use standing::{Standing, Verdict};
