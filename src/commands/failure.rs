//! Failures of commands.

use std::fmt;
use std::io::{self, Write};
use std::process::ExitCode;

use xcscr::agent::Misfit;
use xcscr::trial::{PlanError, RobotError, SettingsError};
use xcscr::world::{MapError, WorldError};
use xcscr::{Error, ErrorKind};

use super::results::Unwritten;
use super::terminal::{escaped, fitted, shows_colours};

/// The beginning of a coloured error message.
const RED_ERROR: &str = "\x1b[1;91merror\x1b[0m";

/// The error that ends a command.
#[derive(Debug)]
pub struct Failure(Error);

impl Failure {
    /// Creates a failure. The message begins with a lowercase letter and ends without a full stop.
    pub fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        Self(kind.error(message))
    }

    /// Returns the conversion of a system error, with what cannot be done.
    pub fn system(what: &str) -> impl Fn(io::Error) -> Self {
        move |cause| Self::new(ErrorKind::Io, format!("cannot {what}: {cause}"))
    }

    /// Creates the failure after a panic, whose own message is already on stderr.
    pub fn internal() -> Self {
        let message = "internal error: please report it with the message above";
        Self::new(ErrorKind::Internal, message)
    }

    /// Returns the kind of the error, which determines the exit code.
    pub fn kind(&self) -> ErrorKind {
        self.0.kind()
    }

    /// Prints the message to stderr. Errors of stderr are ignored.
    pub fn print(&self) {
        let colours = shows_colours(&io::stderr());
        let plain = format!("error: {}", escaped(&self.0.to_string()));
        let fitted = fitted(&plain, &io::stderr());
        let message = if colours {
            fitted.replacen("error", RED_ERROR, 1)
        } else {
            fitted.into_owned()
        };
        if self.kind() != ErrorKind::Closed {
            let _ = writeln!(io::stderr(), "{message}");
        }
    }

    /// Prints the message and returns the exit code.
    pub fn report(&self) -> ExitCode {
        self.print();
        ExitCode::from(self.kind().exit_code())
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self(error)
    }
}

impl From<Unwritten> for Failure {
    fn from(Unwritten(error): Unwritten) -> Self {
        match error.kind() {
            io::ErrorKind::BrokenPipe => Self::new(ErrorKind::Closed, ""),
            _ => Self::new(ErrorKind::Io, format!("cannot write the result: {error}")),
        }
    }
}

impl From<&clap::Error> for Failure {
    fn from(error: &clap::Error) -> Self {
        // Plain text: clap's colours cannot be distinguished from escape codes in an argument.
        let message = error.render().to_string();
        let message = message.strip_prefix("error: ").unwrap_or(&message);
        Self::new(ErrorKind::Usage, message.trim_end())
    }
}

/// Declares errors of the library's layers that are passed on as the library's own.
macro_rules! pass_on {
    ($($error:ty),*) => {
        $(impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Self(error.into())
            }
        })*
    };
}

pass_on!(
    WorldError,
    MapError,
    SettingsError,
    RobotError,
    PlanError,
    Misfit
);
