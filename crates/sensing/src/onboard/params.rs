//! How the filter works that estimates the pose.

use xcs::settings;

settings! {
    section "physics.estimator";

    /// The filter. Its mechanisms have switches, so that what each is good for can be measured.
    pub struct EstimatorParams {
        /// How many times the noise of the sensors' data sheets it assumes. With less it would be
        /// too sure of itself, with more it believes too many beams.
        caution: f64 = 1.3, in 0.5..=5.0;
        /// A beam whose squared distance from a line, in units of its variance, is more than this
        /// is not believed; 3 deviations by default.
        gate: f64 = 9.0, in 1.0..=10_000.0;
        /// Trust the position less where several beams of the last steps disagree with it?
        batch_check: bool = true;
        /// Trust the wheels less in a step in which a bumper closes?
        bump_inflation: bool = true;
        /// Wheels slip that disagree with the gyro by more than this, in m/s, beyond their noise ...
        slip_mps: f64 = 0.2, in 0.02..=10.0;
        /// ... and for so long afterwards the floor is held for slippery, in s.
        slip_s: f64 = 2.0, in 0.0..=60.0;
    }
}
