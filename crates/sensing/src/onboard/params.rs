//! How the filter works that estimates the pose.

use serde::{Deserialize, Serialize};

use xcs::bounds::{OutOfRange, within};

/// The filter. Its mechanisms have switches, so that what each is good for can be measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct EstimatorParams {
    /// How many times the noise of the sensors' data sheets it assumes, 0.5 to 5. With less than
    /// 1.5 it is too sure of itself.
    pub caution: f64,
    /// A beam whose squared distance from a line, in units of its variance, is more than this is
    /// not believed, 1 to 10,000: 3 deviations.
    pub gate: f64,
    /// Trust the pose less when most beams of a step disagree with it?
    pub batch_check: bool,
    /// Trust the wheels less in a step in which a bumper closes?
    pub bump_inflation: bool,
}

impl Default for EstimatorParams {
    fn default() -> Self {
        Self {
            caution: 1.5,
            gate: 9.0,
            batch_check: true,
            bump_inflation: true,
        }
    }
}

impl EstimatorParams {
    /// Accepts the settings when each lies in its range.
    ///
    /// # Errors
    /// Names the first one that does not, and its range.
    pub fn check(&self) -> Result<(), OutOfRange> {
        within("physics.estimator.caution", self.caution, 0.5..=5.0)?;
        within("physics.estimator.gate", self.gate, 1.0..=10_000.0)
    }
}
