//! Faults that make the driver stop.

use strum::IntoStaticStr;

/// The reason why the driver keeps the robot at rest.
#[derive(Debug, Clone, PartialEq, IntoStaticStr, thiserror::Error)]
#[strum(serialize_all = "kebab-case")]
pub enum Fault {
    /// No scan for this many seconds.
    #[error("no scan on /scan for {0:.2} s")]
    NoScans(f64),
    /// No odometry for this many seconds.
    #[error("no odometry on /odom for {0:.2} s")]
    NoOdometry(f64),
    /// Simulated time has stood still for this many seconds.
    #[error("no time on /clock for {0:.2} s")]
    NoClock(f64),
    /// The stamps of a topic jumped. Final.
    #[error("the stamps of {topic} jumped by {by_s:.3} s; restart the driver")]
    ClockJumped {
        /// The topic.
        topic: &'static str,
        /// The jump in seconds; negative if time went backward.
        by_s: f64,
    },
    /// The stamps of a topic are far from those of another one.
    #[error(
        "the stamps of {topic} are {by_s:.2} s off the stamps of {other}; synchronise the clocks"
    )]
    ClocksDisagree {
        /// The topic.
        topic: &'static str,
        /// The other topic.
        other: &'static str,
        /// The difference in seconds; negative if the topic is older.
        by_s: f64,
    },
    /// The last beam of a scan is this many seconds newer than odometry.
    #[error(
        "the last beam of /scan is {0:.2} s newer than /odom; if the stamp is that of the last beam, pass \
         --scan-order reversed"
    )]
    ScanAhead(f64),
    /// This share of a scan's ranges is not a number.
    #[error("{:.0} % of the ranges of a scan are not a number", 100.0 * .0)]
    InvalidRanges(f64),
    /// Hardly any beam of a scan returned, although there are walls: this many.
    #[error("only {0} beams of a scan returned, but there are walls near; uncover the lidar")]
    NoReturns(usize),
    /// A pose or a speed is not a number, or the orientation is no rotation.
    #[error("a pose or a speed on /odom is not a number")]
    InvalidOdometry,
    /// The robot would be faster than it can be, by its reported speed or by its way since the
    /// message before.
    #[error(
        "{what} on /odom is {found:.2}, but at most {most:.2} is possible; restart the driver if this lasts"
    )]
    ImpossibleOdometry {
        /// The quantity with its unit.
        what: &'static str,
        /// Its value.
        found: f64,
        /// The largest possible value.
        most: f64,
    },
    /// A turn rate in rad/s that is not a number, or more than the gyro measures.
    #[error("the turn rate on /imu is {0} rad/s")]
    InvalidImu(f64),
    /// A message has an unexpected frame.
    #[error("{topic} is in the frame `{found}`, but must be in {expected}")]
    WrongFrame {
        /// The topic.
        topic: &'static str,
        /// The frame of the message.
        found: String,
        /// The expected frame.
        expected: String,
    },
    /// A property of a scan does not suit the policy.
    #[error("the {what} of /scan is {found:.3}, but must be from {least:.3} to {most:.3}")]
    WrongLidar {
        /// The property with its unit.
        what: &'static str,
        /// The value in the scan.
        found: f64,
        /// The least value that the policy can use.
        least: f64,
        /// The largest one.
        most: f64,
    },
    /// The pose of the lidar is unknown: the frame of its scans.
    #[error("/tf_static has no transform from the robot to `{0}`; pass --laser X,Y,YAW")]
    NoLaserPose(String),
    /// The lidar is tilted by this angle in degrees.
    #[error("the lidar is tilted by {0:.0} degrees; mount it level or upside down")]
    TiltedLidar(f64),
    /// A publisher or subscriber of a topic is incompatible with the driver.
    #[error("{topic} has an incompatible quality of service: {cause}")]
    WrongQos {
        /// The topic.
        topic: String,
        /// What is incompatible.
        cause: String,
    },
    /// The number of other nodes that publish commands.
    #[error("{}", other_publishers(*.0))]
    OtherPublisher(usize),
    /// No pose of the other localiser for this many seconds.
    #[error("no transform from map to odom on /tf for {0:.2} s")]
    NoLocalisation(f64),
    /// A pose of the other localiser is not of numbers.
    #[error("the transform from map to odom on /tf is not of numbers")]
    InvalidLocalisation,
    /// The pose of the other localiser jumped. The robot begins again.
    #[error("the transform from map to odom on /tf jumped by {by_m:.2} m and {by_rad:.2} rad")]
    LocalisationJumped {
        /// The distance in metres.
        by_m: f64,
        /// The turn in radians.
        by_rad: f64,
    },
    /// The pose of the operator cannot be a start, for this reason.
    #[error("the pose on /initialpose {0}; give another one")]
    InvalidStart(String),
    /// No angles of the wheels for this many seconds.
    #[error("no angles of the wheels on /joint_states for {0:.2} s")]
    NoJoints(f64),
    /// A wheel is missing, its angle is not a number, or it has turned farther than it can.
    #[error(
        "the joint `{joint}` on /joint_states is at {angle_rad} rad; restart the driver if this lasts"
    )]
    InvalidJoints {
        /// The name of the joint.
        joint: String,
        /// Its angle.
        angle_rad: f64,
    },
    /// The robot is not at its estimated position. Final.
    #[error("mislocalised: {0}; restart the driver")]
    Mislocalised(Mislocalised),
    /// The caller requested the end. Final.
    #[error("interrupted")]
    Interrupted,
}

/// The evidence that the estimate is wrong.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Mislocalised {
    /// The standard deviation of the position in metres, which exceeds a quarter of a cell.
    #[error("the position is uncertain by {0:.2} m")]
    Unsure(f64),
    /// The estimated cell is a wall, or outside of the maze.
    #[error("the estimated cell is a wall or outside of the maze")]
    InAWall,
    /// The share of beams that do not end at the walls of the maze.
    #[error("{:.0} % of the beams do not end at the walls of the maze", 100.0 * .0)]
    ScanDisagrees(f64),
}

impl Fault {
    /// Returns true if the fault lasts until the driver is restarted. Otherwise the robot continues
    /// once the fault is over.
    pub fn is_final(&self) -> bool {
        match self {
            Self::ClockJumped { .. } | Self::Mislocalised(_) | Self::Interrupted => true,
            Self::NoScans(_)
            | Self::NoOdometry(_)
            | Self::NoClock(_)
            | Self::ClocksDisagree { .. }
            | Self::ScanAhead(_)
            | Self::InvalidRanges(_)
            | Self::NoReturns(_)
            | Self::InvalidOdometry
            | Self::ImpossibleOdometry { .. }
            | Self::InvalidImu(_)
            | Self::WrongFrame { .. }
            | Self::WrongLidar { .. }
            | Self::NoLaserPose(_)
            | Self::NoLocalisation(_)
            | Self::InvalidLocalisation
            | Self::LocalisationJumped { .. }
            | Self::InvalidStart(_)
            | Self::NoJoints(_)
            | Self::InvalidJoints { .. }
            | Self::TiltedLidar(_)
            | Self::WrongQos { .. }
            | Self::OtherPublisher(_) => false,
        }
    }

    /// Returns a short name, the same for all faults of a kind.
    pub fn name(&self) -> &'static str {
        self.into()
    }
}

fn other_publishers(count: usize) -> String {
    match count {
        1 => "another node publishes on /cmd_vel; stop it".to_owned(),
        _ => format!("{count} other nodes publish on /cmd_vel; stop them"),
    }
}
