//! Who is credited, with what, and when: standard XCS, and the mechanisms of the paper.

mod combined;
mod imprinting;
mod learning_rate;
pub(super) mod mind;
mod short_term_filter;
mod stack;
mod standard;
mod step_threshold;

pub use combined::Combined;
pub use standard::Standard;
