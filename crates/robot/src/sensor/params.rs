//! Settings of the percepts.

use xcs::settings;

use super::history::MOST_EARLIER_STEPS;

settings! {
    section "sensor";

    /// Settings of the percepts.
    pub struct SensorParams {
        /// Observation noise: the probability that a bit of a percept is inverted. Each bit is drawn
        /// independently after each action. All methods treat every percept as correct.
        flip_probability: f64 = 0.0, in 0.0..=0.1;
        /// The number of earlier steps that learners perceive: each percept is followed by the last actions, and by
        /// the percepts in which they were taken. An episode begins without earlier steps.
        history: u32 = 0, in 0..=MOST_EARLIER_STEPS;
    }
}
