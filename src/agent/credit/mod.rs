//! Who is credited, with what, and when: standard XCS, and the mechanisms of the paper.

mod adapted;
mod combined;
mod imprinting;
mod learning_rate;
pub(super) mod mind;
mod params;
mod short_term_filter;
mod stack;
mod standard;
mod step_threshold;

pub use adapted::Adapted;
pub use combined::Combined;
pub use params::{Params, Sharing, StackEvolution, StepLimitUpdate, XcsPayment};
pub use standard::Standard;
