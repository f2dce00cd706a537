//! Statistics of finished trials; they know nothing of mazes or learners.
//!
//! All of them are deterministic: what resamples takes its own random stream.

mod bootstrap;
mod fisher;
mod iqm;
mod paired;
mod proportion;
mod survival;

pub use bootstrap::bootstrap_interval;
pub use fisher::{fisher_exact, holm};
pub use iqm::{iqm, quantile};
pub use paired::{Pairs, share_to_be_found};
pub use proportion::{Proportion, difference_to_be_found, trials_needed};
pub use survival::{Lifetime, Point, Survival, log_rank};

/// The normal deviate that leaves 2.5 % on either side.
const Z_95: f64 = 1.959_963_984_540_054;

/// An estimate between its lower and upper 95 % limit.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Interval {
    /// The estimate.
    pub value: f64,
    /// The lower limit.
    pub low: f64,
    /// The upper limit.
    pub high: f64,
}
