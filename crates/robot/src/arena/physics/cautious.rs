//! Driving carefully: gently enough for a slippery floor.

use serde::{Deserialize, Serialize};

use xcs::settings;

/// When the robot drives carefully.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Care {
    /// Never.
    Never,
    /// As soon as it notices that its wheels slip, and for a while afterwards. Only a robot that
    /// senses can.
    #[default]
    Slipping,
    /// Always.
    Always,
}

settings! {
    section "physics.cautious";

    /// Driving carefully. The defaults hold on a friction of 0.3, which gives 2.94 m/s^2.
    pub struct CautiousParams {
        /// When it does: `never`, `slipping` (as soon as it notices that its wheels slip, and for a
        /// while afterwards) or `always`.
        when: Care = Care::Slipping;
        /// The largest wheel acceleration then, in m/s^2.
        wheel_acceleration_mps2: f64 = 2.9, in 0.05..=20.0;
        /// The deceleration before the target then, in m/s^2.
        deceleration_mps2: f64 = 1.5, in 0.05..=10.0;
        /// The angular deceleration at the end of a turn then, in rad/s^2.
        turn_deceleration_radps2: f64 = 6.0, in 0.2..=30.0;
    }
}
