//! The publisher of commands.

use ros2_client::{Gid, Publisher};
use serde::Serialize;

use super::link::{Link, STAMPED, TWIST, reliable};
use crate::arena::Speeds;
use crate::drive::drive_messages::{Twist, TwistStamped};
use crate::{Error, ErrorKind};

/// The publisher of commands.
pub enum Velocity {
    Plain(Publisher<Twist>),
    Stamped(Publisher<TwistStamped>),
}

impl Velocity {
    /// Creates the publisher, of stamped commands or of others.
    pub fn open(link: &mut Link, stamped: bool) -> Result<Self, Error> {
        Ok(if stamped {
            Self::Stamped(publisher_of(link, STAMPED)?)
        } else {
            Self::Plain(publisher_of(link, TWIST)?)
        })
    }

    /// Returns the identity of the publisher.
    pub fn gid(&self) -> Gid {
        match self {
            Self::Plain(to) => to.gid(),
            Self::Stamped(to) => to.gid(),
        }
    }

    /// Publishes a command with the time of sending.
    pub fn publish(&self, time_ns: u64, speeds: Speeds) -> Result<(), Error> {
        let fault = |cause: String| {
            let message = format!("cannot publish on /cmd_vel: {cause}");
            ErrorKind::Io.error(message)
        };
        match self {
            Self::Plain(to) => to
                .publish(speeds.into())
                .map_err(|cause| fault(format!("{cause:?}"))),
            Self::Stamped(to) => to
                .publish(TwistStamped::new(time_ns, speeds))
                .map_err(|cause| fault(format!("{cause:?}"))),
        }
    }
}

fn publisher_of<M: Serialize>(link: &mut Link, kind: [&str; 2]) -> Result<Publisher<M>, Error> {
    link.publisher("cmd_vel", kind, &reliable())
}
