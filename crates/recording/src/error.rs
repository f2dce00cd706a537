//! The error of the library: its kind, and a message that says what to do.

use std::io;
use std::path::Path;

use xcs::bounds::OutOfRange;
use xcscr_learner::agent::Misfit;
use xcscr_learner::trial::{PlanError, RobotError, SettingsError};
use xcscr_robot::arena::PhysicsError;
use xcscr_robot::world::{MapError, WorldError, bundled_world};

/// The kinds of errors. Each has its own exit code of the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorKind {
    /// The reader of the output has closed it. This is a clean exit.
    Closed,
    /// A condition that the user requested does not hold.
    Refuted,
    /// Invalid or contradictory arguments.
    Usage,
    /// Bad input data.
    BadData,
    /// An input is missing.
    Missing,
    /// An internal error of this program.
    Internal,
    /// The output cannot be created, for example because another process uses it.
    CannotCreate,
    /// Input or output error.
    Io,
    /// Interrupted. The work can be continued.
    Interrupted,
}

impl ErrorKind {
    /// Returns the exit code of the program, as explained by `--help`.
    pub fn exit_code(self) -> u8 {
        match self {
            Self::Closed => 0,
            Self::Refuted => 1,
            Self::Usage => 2,
            Self::BadData => 65,
            Self::Missing => 66,
            Self::Internal => 70,
            Self::CannotCreate => 73,
            Self::Io => 74,
            Self::Interrupted => 75,
        }
    }

    /// Returns an error of this kind. The message begins with a lowercase letter and ends without a
    /// full stop.
    pub fn error(self, message: impl Into<String>) -> Error {
        Error {
            kind: self,
            message: message.into(),
        }
    }

    /// Returns the kind of an error when reading an input.
    pub fn of_reading(cause: &io::Error) -> Self {
        match cause.kind() {
            io::ErrorKind::NotFound => Self::Missing,
            io::ErrorKind::InvalidData | io::ErrorKind::FileTooLarge => Self::BadData,
            _ => Self::Io,
        }
    }
}

/// An error of the library, created by [`ErrorKind::error`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct Error {
    kind: ErrorKind,
    message: String,
}

impl Error {
    /// Returns the kind.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }

    /// Adds a hint to the end of the message.
    pub fn with_hint(self, hint: &str) -> Self {
        self.kind.error(format!("{self}; {hint}"))
    }
}

/// Returns the error for a bundled world in the place of a run, if `path` is the name of one.
pub fn world_for_run(path: &Path) -> Option<Error> {
    let name = path
        .to_str()
        .filter(|name| bundled_world(name).is_some() && !path.exists())?;
    let message = format!(
        "{name} is a world, not a run: train in it with `xcscr train {name}`, and pass the folder of the run"
    );
    Some(ErrorKind::Missing.error(message))
}

impl From<WorldError> for Error {
    fn from(error: WorldError) -> Self {
        let kind = match &error {
            WorldError::Missing { .. } => ErrorKind::Missing,
            WorldError::Invalid(_) => ErrorKind::BadData,
            _ => ErrorKind::Io,
        };
        kind.error(error.to_string())
    }
}

impl From<MapError> for Error {
    fn from(error: MapError) -> Self {
        let kind = match &error {
            MapError::Unreadable { cause, .. } => ErrorKind::of_reading(cause),
            MapError::Cell(_) | MapError::NoGoal | MapError::Point { .. } => ErrorKind::Usage,
            _ => ErrorKind::BadData,
        };
        match error {
            MapError::World(error) => error.into(),
            _ => kind.error(error.to_string()),
        }
    }
}

/// Declares errors whose cause is always bad data.
macro_rules! bad_data {
    ($($error:ty),*) => {
        $(impl From<$error> for Error {
            fn from(error: $error) -> Self {
                ErrorKind::BadData.error(error.to_string())
            }
        })*
    };
}

bad_data!(Misfit, OutOfRange, PhysicsError, PlanError, SettingsError);

impl From<RobotError> for Error {
    fn from(error: RobotError) -> Self {
        let kind = match &error {
            RobotError::Unknown { .. } => ErrorKind::Missing,
            RobotError::Read { cause, .. } => ErrorKind::of_reading(cause),
            RobotError::Invalid { .. } | RobotError::Settings(_) => ErrorKind::BadData,
        };
        kind.error(error.to_string())
    }
}
