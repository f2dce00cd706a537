//! The search for settings: successive halving over seeds.
//!
//! All candidates begin with few seeds. After each rung the worse half leaves, and so does who is
//! behind the leader for sure; the trials of the next rung are shared out among those that stay. The
//! finalists meet on seeds that the search has not seen. Every rung is a [study in
//! tasks](super::PlannedStudy), so that a search runs wherever studies do, and goes on where it was
//! interrupted: what comes next follows from what is finished.

mod candidates;
mod search;
mod standing;

pub use search::{Found, Rung, Stage, Tuning};
pub use standing::{Standing, Verdict};
