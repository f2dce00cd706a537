//! Faults that make the driver stop.

use std::fmt;

/// The reason why the driver keeps the robot at rest.
#[derive(Debug, Clone, PartialEq)]
pub enum Fault {
    /// No scan for this many seconds.
    NoScans(f64),
    /// No odometry for this many seconds.
    NoOdometry(f64),
    /// Simulated time has stood still for this many seconds.
    NoClock(f64),
    /// The stamps of a topic jumped. Final.
    ClockJumped {
        /// The topic.
        topic: &'static str,
        /// The jump in seconds; negative if time went backward.
        by_s: f64,
    },
    /// A scan is this many seconds newer than odometry, or older if negative.
    ClocksDisagree(f64),
    /// The last beam of a scan is this many seconds newer than odometry.
    ScanAhead(f64),
    /// This share of a scan's ranges is not a number, or the scan has no ranges.
    InvalidRanges(f64),
    /// Hardly any beam of a scan returned: this many.
    NoReturns(usize),
    /// A pose or a speed is not a number.
    InvalidOdometry,
    /// A message has an unexpected frame.
    WrongFrame {
        /// The topic.
        topic: &'static str,
        /// The frame of the message.
        found: String,
        /// The expected frame.
        expected: String,
    },
    /// The lidar differs from the one the policy was trained with.
    WrongLidar {
        /// The property that differs.
        what: &'static str,
        /// The value in the scan.
        found: f64,
        /// The value in the robot's profile.
        expected: f64,
    },
    /// A publisher or subscriber of a topic is incompatible with the driver.
    WrongQos {
        /// The topic.
        topic: String,
        /// What is incompatible.
        cause: String,
    },
    /// The number of other nodes that publish commands.
    OtherPublisher(usize),
    /// The robot is not at its estimated position. Final.
    Mislocalised(Mislocalised),
    /// The caller requested the end. Final.
    Interrupted,
}

/// The evidence that the estimate is wrong.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Mislocalised {
    /// The standard deviation of the position in metres, which exceeds a quarter of a cell.
    Unsure(f64),
    /// The estimated cell is a wall, or outside of the maze.
    InAWall,
    /// The share of beams that do not end at the walls of the maze.
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
            | Self::ClocksDisagree(_)
            | Self::ScanAhead(_)
            | Self::InvalidRanges(_)
            | Self::NoReturns(_)
            | Self::InvalidOdometry
            | Self::WrongFrame { .. }
            | Self::WrongLidar { .. }
            | Self::WrongQos { .. }
            | Self::OtherPublisher(_) => false,
        }
    }

    /// Returns a short name, the same for all faults of a kind.
    pub fn name(&self) -> &'static str {
        match self {
            Self::NoScans(_) => "no-scans",
            Self::NoOdometry(_) => "no-odometry",
            Self::NoClock(_) => "no-clock",
            Self::ClockJumped { .. } => "clock-jumped",
            Self::ClocksDisagree(_) => "clocks-disagree",
            Self::ScanAhead(_) => "scan-ahead",
            Self::InvalidRanges(_) => "invalid-ranges",
            Self::NoReturns(_) => "no-returns",
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
                    "the stamps of {topic} jumped by {by_s:.3} s; restart the driver"
                )
            }
            Self::ClocksDisagree(by_s) => write!(
                to,
                "the stamps of /scan are {by_s:.2} s off the stamps of /odom; synchronise the clocks"
            ),
            Self::ScanAhead(by_s) => write!(
                to,
                "the last beam of /scan is {by_s:.2} s newer than /odom; if the stamp is that of the last beam, pass \
                 --reversed-scans"
            ),
            Self::InvalidRanges(share) => write!(
                to,
                "{:.0} % of the ranges of a scan are not a number",
                100.0 * share
            ),
            Self::NoReturns(count) => write!(
                to,
                "only {count} beams of a scan returned; uncover the lidar, or bring the robot nearer to a wall"
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
            Self::OtherPublisher(1) => write!(to, "another node publishes on /cmd_vel; stop it"),
            Self::OtherPublisher(count) => {
                write!(to, "{count} other nodes publish on /cmd_vel; stop them")
            }
            Self::Mislocalised(cause) => write!(to, "mislocalised: {cause}; restart the driver"),
            Self::Interrupted => write!(to, "interrupted"),
        }
    }
}

impl fmt::Display for Mislocalised {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unsure(deviation_m) => {
                write!(to, "the position is uncertain by {deviation_m:.2} m")
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
