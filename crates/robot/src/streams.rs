//! The named streams of random numbers. Each user draws from its own sequence, so that switching
//! one off does not change the others.

/// The users of random numbers; see [`xcs::random::Stream::new`]. A seed gives the same bytes only
/// if the numbers stay the same: add new names at the end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StreamName {
    /// The cell in which an episode starts.
    Start,
    /// Whether to explore, and the random action.
    Exploration,
    /// Covering, the genetic algorithm and deletion.
    Evolution,
    /// Whether to imprint, and which policy of \[PS\].
    Imprinting,
    /// Noise of the wheels and of the measured pose.
    Physics,
    /// Resampling in statistics.
    Bootstrap,
    /// Generated worlds.
    World,
    /// The remembered transitions that are replayed.
    Replay,
    /// The lidar: its scale, and the noise of its beams.
    Lidar,
    /// The encoders: the scales of the wheels.
    Encoders,
    /// The gyro: bias, scale and noise.
    Gyro,
    /// Which actions slip, and the actions executed in their place.
    Slip,
    /// Percepts on which an exported policy is compared with the learned one.
    Export,
    /// The policy that the policy selector of `xcscr-coevolved` chooses.
    Experts,
    /// The rules of the policy selector of `xcscr-coevolved`.
    PolicySelector,
    /// The rules of the behaviour cloner of `xcscr-coevolved`.
    BehaviourCloner,
    /// The bits of a percept that observation noise inverts.
    ObservationNoise,
    /// Ties between equally good paths of planned exploration.
    Planning,
}

impl From<StreamName> for u64 {
    fn from(name: StreamName) -> Self {
        name as Self
    }
}
