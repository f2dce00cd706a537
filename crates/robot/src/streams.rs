//! The named streams of random numbers: who draws, each from a sequence of its own, so that
//! switching one of them off does not move the others.

/// Who draws random numbers; see [`xcs::random::Stream::new`]. The numbers are part of what makes
/// a seed give the same bytes: new names go to the end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StreamName {
    /// The cell in which an episode starts.
    Start,
    /// Explore or exploit, and which action.
    Exploration,
    /// Covering, the genetic algorithm and deletion.
    Evolution,
    /// Imprinting: whether, and which policy of \[PS\].
    Imprinting,
    /// Noise of wheels and pose.
    Physics,
    /// Resampling in statistics.
    Bootstrap,
    /// Generated worlds.
    World,
    /// Which remembered transitions are replayed.
    Replay,
    /// The lidar: its scale, and the noise of its beams.
    Lidar,
    /// The scales of the wheels, as the encoders have them.
    Encoders,
    /// The gyro: bias, scale and noise.
    Gyro,
    /// Which actions slip, and to which others.
    Slip,
    /// Percepts on which an exported policy is compared with what was learned.
    Export,
    /// Which policy the keeper of `xcscr-coevolved` chooses.
    Experts,
    /// The rules of that keeper.
    Keeper,
    /// The rules of the cloner of `xcscr-coevolved`.
    BehaviourCloner,
    /// Which bits of a percept flip.
    Flips,
}

impl From<StreamName> for u64 {
    fn from(name: StreamName) -> Self {
        name as Self
    }
}
