//! Settings of what is perceived.

use xcs::settings;

settings! {
    section "sensor";

    /// Settings of what is perceived.
    pub struct SensorParams {
        /// The probability that a bit of what is perceived is flipped, whatever the percept: each
        /// bit for itself, and anew after each action. Only `xcscr-plus` and `r-max`
        /// correct such errors, with their map; all other methods take every percept for right.
        flip_probability: f64 = 0.0, in 0.0..=0.1;
    }
}
