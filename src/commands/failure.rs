//! Failures of commands, and their exit codes.

use std::fmt;
use std::io::{self, Write};
use std::process::ExitCode;

use xcscr::record::RecordError;
use xcscr::run::{RunError, RunFolder, RunFolderError};
use xcscr::trial::{PlanError, RobotError, SettingsError};
use xcscr::world::WorldError;

use super::terminal::{escaped, fitted, shows_colours};

/// The beginning of a coloured error message.
const RED_ERROR: &str = "\x1b[1;91merror\x1b[0m";

/// The exit codes of failed commands, as explained by `--help`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// The reader of stdout has closed it. This is a clean exit.
    Closed = 0,
    /// A condition that the user requested does not hold.
    Refuted = 1,
    /// Invalid or contradictory arguments.
    Usage = 2,
    /// The command succeeded, but some data was lost.
    Lossy = 3,
    /// Bad input data.
    BadData = 65,
    /// An input file is missing.
    Missing = 66,
    /// An internal error of this program.
    Internal = 70,
    /// The output cannot be created.
    CannotCreate = 73,
    /// Input or output error.
    Io = 74,
    /// Interrupted. A valid checkpoint was left.
    Interrupted = 75,
}

/// An exit code and its message.
#[derive(Debug)]
pub struct Failure {
    /// The exit code.
    pub exit: Exit,
    message: String,
    /// The coloured message, if there is one.
    styled: Option<String>,
}

impl Failure {
    /// Creates a failure. The message begins with a lowercase letter and ends without a full stop.
    pub fn new(exit: Exit, message: impl Into<String>) -> Self {
        Self {
            exit,
            message: message.into(),
            styled: None,
        }
    }

    /// Creates the failure after a panic, whose own message is already on stderr.
    pub fn internal() -> Self {
        let message = "internal error: please report it with the message above";
        Self::new(Exit::Internal, message)
    }

    /// Prints the message to stderr. Errors of stderr are ignored.
    pub fn print(&self) {
        let plain = escaped(&self.message);
        let message = match &self.styled {
            Some(styled) if shows_colours(&io::stderr()) => {
                format!("{RED_ERROR}: {styled}")
            }
            _ => {
                let plain = format!("error: {plain}");
                let fitted = fitted(&plain, &io::stderr());
                match shows_colours(&io::stderr()) {
                    true => fitted.replacen("error", RED_ERROR, 1),
                    false => fitted.into_owned(),
                }
            }
        };
        if self.exit != Exit::Closed {
            let _ = writeln!(io::stderr(), "{message}");
        }
    }

    /// Prints the message and returns the exit code.
    pub fn report(&self) -> ExitCode {
        self.print();
        ExitCode::from(self.exit as u8)
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::BrokenPipe => Self::new(Exit::Closed, ""),
            _ => Self::new(Exit::Io, format!("cannot write the result: {error}")),
        }
    }
}

impl From<&clap::Error> for Failure {
    fn from(error: &clap::Error) -> Self {
        // Plain text: clap's colours cannot be distinguished from escape codes in an argument.
        let message = error.render().to_string();
        let message = message.strip_prefix("error: ").unwrap_or(&message);
        Self::new(Exit::Usage, message.trim_end())
    }
}

impl From<serde_json::Error> for Failure {
    fn from(error: serde_json::Error) -> Self {
        io::Error::from(error).into()
    }
}

impl From<WorldError> for Failure {
    fn from(error: WorldError) -> Self {
        match &error {
            WorldError::Missing { .. } => Self::new(Exit::Missing, error.to_string()),
            WorldError::Invalid(fault) => Self {
                styled: Some(fault.styled().to_string()),
                ..Self::new(Exit::BadData, error.to_string())
            },
            _ => Self::new(Exit::Io, error.to_string()),
        }
    }
}

impl From<SettingsError> for Failure {
    fn from(error: SettingsError) -> Self {
        Self::new(Exit::BadData, error.to_string())
    }
}

impl From<RobotError> for Failure {
    fn from(error: RobotError) -> Self {
        let exit = match &error {
            RobotError::Unknown { .. } => Exit::Missing,
            RobotError::Read { cause, .. } if cause.kind() == io::ErrorKind::NotFound => {
                Exit::Missing
            }
            RobotError::Read { .. } => Exit::Io,
            RobotError::Invalid { .. } | RobotError::Settings(_) => Exit::BadData,
        };
        Self::new(exit, error.to_string())
    }
}

impl From<PlanError> for Failure {
    fn from(error: PlanError) -> Self {
        Self::new(Exit::BadData, error.to_string())
    }
}

impl From<RunFolderError> for Failure {
    fn from(error: RunFolderError) -> Self {
        let exit = match error {
            RunFolderError::World(error) => return error.into(),
            RunFolderError::Exists(_)
            | RunFolderError::Foreign(_)
            | RunFolderError::Interrupted(_)
            | RunFolderError::InUse { .. }
            | RunFolderError::InTheWay(_)
            | RunFolderError::Create { .. } => Exit::CannotCreate,
            RunFolderError::Missing(_) | RunFolderError::NothingToResume(_) => Exit::Missing,
            RunFolderError::Damaged { .. }
            | RunFolderError::Changed(_)
            | RunFolderError::Checkpoint { .. } => Exit::BadData,
            RunFolderError::Io { .. } | RunFolderError::Write { .. } => Exit::Io,
        };
        Self::new(exit, error.to_string())
    }
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        let message = error.to_string();
        match error {
            RunError::Folder(error) => error.into(),
            RunError::Plan(error) => error.into(),
            RunError::World(error) => error.into(),
            RunError::Record(error) => error.into(),
            RunError::Recording { .. } | RunError::TwoRuns(_) | RunError::NoHighlights { .. } => {
                Self::new(Exit::BadData, message)
            }
            RunError::Interrupted { .. } => Self::new(Exit::Interrupted, message),
            RunError::Resumable { cause, .. } => Self::new(Self::from(*cause).exit, message),
            _ => Self::new(Exit::CannotCreate, message),
        }
    }
}

impl From<RecordError> for Failure {
    fn from(error: RecordError) -> Self {
        let exit = match error {
            RecordError::Create { .. } => Exit::CannotCreate,
            RecordError::Unfinished { .. }
            | RecordError::Foreign { .. }
            | RecordError::Damaged { .. } => Exit::BadData,
            RecordError::Read { ref cause, .. } if cause.kind() == io::ErrorKind::FileTooLarge => {
                Exit::BadData
            }
            RecordError::Read { ref cause, .. } if cause.kind() == io::ErrorKind::NotFound => {
                Exit::Missing
            }
            _ => Exit::Io,
        };
        let stopped = match &error {
            RecordError::Unfinished { path } => path.parent().and_then(RunFolder::way_to_resume),
            _ => None,
        };
        let message = stopped.map_or(error.to_string(), |way_on| {
            format!("this run was interrupted, and no viewer can open its unfinished recording; {way_on}")
        });
        Self::new(exit, message)
    }
}
