//! The results of a command, which go to stdout.

use std::fmt;
use std::io::{self, StdoutLock, Write};

use super::terminal::Escaping;

/// The results on stdout, with control characters escaped.
pub struct Results(Escaping<StdoutLock<'static>>);

/// The error that a result cannot be written to stdout. No other error of the system becomes it.
#[derive(Debug)]
pub struct Unwritten(pub io::Error);

impl Results {
    /// Locks stdout.
    pub fn lock() -> Self {
        Self(Escaping::new(io::stdout().lock()))
    }

    /// Writes formatted text, for `write!` and `writeln!`.
    pub fn write_fmt(&mut self, text: fmt::Arguments<'_>) -> Result<(), Unwritten> {
        self.0.write_fmt(text).map_err(Unwritten)
    }

    /// Writes bytes.
    pub fn write_all(&mut self, bytes: &[u8]) -> Result<(), Unwritten> {
        self.0.write_all(bytes).map_err(Unwritten)
    }

    /// Writes what is buffered.
    pub fn flush(&mut self) -> Result<(), Unwritten> {
        self.0.flush().map_err(Unwritten)
    }
}
