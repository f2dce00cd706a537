//! How the filter works that estimates the pose.

use xcs::settings;

settings! {
    section "physics.estimator";

    /// The filter. Its mechanisms have switches, so that what each is good for can be measured.
    pub struct EstimatorParams {
        /// How many times the noise of the sensors' data sheets it assumes. With less than 1.5 it
        /// is too sure of itself.
        caution: f64 = 1.5, in 0.5..=5.0;
        /// A beam whose squared distance from a line, in units of its variance, is more than this
        /// is not believed; 3 deviations by default.
        gate: f64 = 9.0, in 1.0..=10_000.0;
        /// Trust the pose less when most beams of a step disagree with it?
        batch_check: bool = true;
        /// Trust the wheels less in a step in which a bumper closes?
        bump_inflation: bool = true;
    }
}
