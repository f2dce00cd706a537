//! What makes the driver stop.

use std::fmt;

/// Why the driver holds the robot at rest.
#[derive(Debug, Clone, PartialEq)]
pub enum Fault {
    /// No scan for so many seconds.
    NoScans(f64),
    /// No odometry for so many seconds.
    NoOdometry(f64),
    /// Simulated time stands still for so many seconds.
    NoClock(f64),
    /// The stamps of a topic jumped by so many seconds. Final.
    ClockJumped {
        /// The topic.
        topic: &'static str,
        /// By how much; negative when time went backward.
        by_s: f64,
    },
    /// A scan is so many seconds older than odometry, or newer.
    ClocksDisagree(f64),
    /// This share of a scan is not a number, or it has no ranges.
    InvalidRanges(f64),
    /// A pose or a speed is not a number.
    InvalidOdometry,
    /// A message has another frame than expected.
    WrongFrame {
        /// The topic.
        topic: &'static str,
        /// Its frame.
        found: String,
        /// The frame that was expected.
        expected: String,
    },
    /// The lidar is not the one that the policy was trained with.
    WrongLidar {
        /// What differs.
        what: &'static str,
        /// What the scan says.
        found: f64,
        /// What the robot's profile says.
        expected: f64,
    },
    /// A peer on a topic cannot be heard, or cannot hear.
    WrongQos {
        /// The topic.
        topic: String,
        /// What does not fit.
        cause: String,
    },
    /// So many other nodes publish commands.
    OtherPublisher(usize),
    /// The robot is not where it is estimated to be. Final.
    Mislocalised(Mislocalised),
    /// Somebody asked for the end. Final.
    Interrupted,
}

/// What shows that the estimate is wrong.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Mislocalised {
    /// The deviation of the estimated position in metres is more than a quarter of a cell.
    Unsure(f64),
    /// The estimated cell is a wall, or outside of the maze.
    InAWall,
    /// This share of the beams ends elsewhere than the walls of the maze say.
    ScanDisagrees(f64),
}

impl Fault {
    /// Does it last until the driver is started again? Otherwise the robot goes on once the fault is over.
    pub fn is_final(&self) -> bool {
        match self {
            Self::ClockJumped { .. } | Self::Mislocalised(_) | Self::Interrupted => true,
            Self::NoScans(_)
            | Self::NoOdometry(_)
            | Self::NoClock(_)
            | Self::ClocksDisagree(_)
            | Self::InvalidRanges(_)
            | Self::InvalidOdometry
            | Self::WrongFrame { .. }
            | Self::WrongLidar { .. }
            | Self::WrongQos { .. }
            | Self::OtherPublisher(_) => false,
        }
    }

    /// A short name, the same for all faults of a kind.
    pub fn name(&self) -> &'static str {
        match self {
            Self::NoScans(_) => "no-scans",
            Self::NoOdometry(_) => "no-odometry",
            Self::NoClock(_) => "no-clock",
            Self::ClockJumped { .. } => "clock-jumped",
            Self::ClocksDisagree(_) => "clocks-disagree",
            Self::InvalidRanges(_) => "invalid-ranges",
            Self::InvalidOdometry => "invalid-odometry",
            Self::WrongFrame { .. } => "wrong-frame",
            Self::WrongLidar { .. } => "wrong-lidar",
            Self::WrongQos { .. } => "wrong-qos",
            Self::OtherPublisher(_) => "other-publisher",
            Self::Mislocalised(_) => "mislocalised",
            Self::Interrupted => "interrupted",
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoScans(age_s) => write!(to, "no scan on /scan for {age_s:.2} s"),
            Self::NoOdometry(age_s) => write!(to, "no odometry on /odom for {age_s:.2} s"),
            Self::NoClock(age_s) => write!(to, "no time on /clock for {age_s:.2} s"),
            Self::ClockJumped { topic, by_s } => {
                write!(
                    to,
                    "the stamps of {topic} jumped by {by_s:.3} s; start again"
                )
            }
            Self::ClocksDisagree(by_s) => write!(
                to,
                "the stamps of /scan are {by_s:.2} s off those of /odom; set the clocks"
            ),
            Self::InvalidRanges(share) => write!(
                to,
                "{:.0} % of the ranges of a scan are not a number",
                100.0 * share
            ),
            Self::InvalidOdometry => write!(to, "a pose or a speed on /odom is not a number"),
            Self::WrongFrame {
                topic,
                found,
                expected,
            } => write!(
                to,
                "{topic} is in the frame `{found}`, but must be in {expected}"
            ),
            Self::WrongLidar {
                what,
                found,
                expected,
            } => write!(
                to,
                "another lidar than the policy was trained with: {what} {found}, but {expected} in the profile"
            ),
            Self::WrongQos { topic, cause } => {
                write!(
                    to,
                    "{topic} has an incompatible quality of service: {cause}"
                )
            }
            Self::OtherPublisher(1) => write!(to, "another node publishes on /cmd_vel; end it"),
            Self::OtherPublisher(count) => {
                write!(to, "{count} other nodes publish on /cmd_vel; end them")
            }
            Self::Mislocalised(cause) => write!(to, "mislocalised: {cause}; start again"),
            Self::Interrupted => write!(to, "interrupted"),
        }
    }
}

impl fmt::Display for Mislocalised {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unsure(deviation_m) => {
                write!(to, "the position is known to {deviation_m:.2} m only")
            }
            Self::InAWall => write!(to, "the estimated cell is a wall or outside of the maze"),
            Self::ScanDisagrees(share) => write!(
                to,
                "{:.0} % of the beams do not end at the walls of the maze",
                100.0 * share
            ),
        }
    }
}
