//! The learner XCS.

mod prediction;

pub use prediction::PredictionArray;

/// The population.
#[derive(Debug, Clone)]
pub struct Population;
