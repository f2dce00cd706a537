//! Cautious driving: gentle enough for a slippery floor.

use serde::{Deserialize, Serialize};

use super::params::PhysicsParams;
use xcs::settings;

/// Returns the driving settings, `usual` or `careful`, given whether wheel slip is detected.
pub(super) fn profile<'a>(
    usual: &'a PhysicsParams,
    careful: &'a PhysicsParams,
    slips: bool,
) -> &'a PhysicsParams {
    match usual.cautious.when {
        CautiousDriving::Always => careful,
        CautiousDriving::Slipping if slips => careful,
        CautiousDriving::Slipping | CautiousDriving::Never => usual,
    }
}

/// When the robot drives cautiously.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CautiousDriving {
    /// Never.
    Never,
    /// From the moment it detects wheel slip, and for a while afterwards. Only a robot with sensors
    /// can.
    #[default]
    Slipping,
    /// Always.
    Always,
}

settings! {
    section "physics.cautious";

    /// Cautious driving. The defaults hold on a friction of 0.3, which gives 2.94 m/s^2.
    pub struct CautiousParams {
        /// When to drive cautiously: `never`, `slipping` (from the moment the robot detects wheel
        /// slip, and for a while afterwards) or `always`.
        when: CautiousDriving = CautiousDriving::Slipping;
        /// Largest wheel acceleration in cautious driving, in m/s^2.
        wheel_acceleration_mps2: f64 = 2.9, in 0.05..=20.0;
        /// Deceleration before the target in cautious driving, in m/s^2.
        deceleration_mps2: f64 = 1.5, in 0.05..=10.0;
        /// Angular deceleration at the end of a turn in cautious driving, in rad/s^2.
        turn_deceleration_radps2: f64 = 6.0, in 0.2..=30.0;
    }
}
