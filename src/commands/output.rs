//! JSON documents on stdout, and output files named by the user.

use std::io;
use std::path::Path;

use serde::Serialize;
use xcscr::ErrorKind;
use xcscr::disk;

use super::failure::Failure;
use super::results::Results;

/// Prints one JSON document.
pub fn print_json(value: &impl Serialize, out: &mut Results) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value).map_err(|fault| {
        Failure::new(
            ErrorKind::Internal,
            format!("no JSON for the result: {fault}"),
        )
    })?;
    Ok(writeln!(out, "{text}")?)
}

/// An output file that is checked before the work for it begins.
#[derive(Debug)]
pub struct OutputFile<'a> {
    path: &'a Path,
    force: bool,
}

impl<'a> OutputFile<'a> {
    /// Fails if the file exists and `force` is not set, or if the file cannot be written.
    pub fn free(path: &'a Path, force: bool) -> Result<Self, Failure> {
        disk::require_free(path, force)
            .and_then(|()| require_folder(path))
            .map_err(|cause| unwritten(path, &cause))?;
        Ok(Self { path, force })
    }

    /// Writes the file atomically.
    pub fn write(&self, bytes: &[u8]) -> Result<(), Failure> {
        disk::write(self.path, bytes, self.force).map_err(|cause| unwritten(self.path, &cause))
    }
}

/// Fails if the folder of the file does not exist.
fn require_folder(path: &Path) -> io::Result<()> {
    let named = |folder: &&Path| !folder.as_os_str().is_empty();
    match path.parent().filter(named) {
        Some(folder) if !folder.is_dir() => Err(io::Error::new(
            io::ErrorKind::NotADirectory,
            "there is no such folder; create it first, or choose another",
        )),
        _ => Ok(()),
    }
}

fn unwritten(path: &Path, cause: &io::Error) -> Failure {
    let kind = match cause.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::FileTooLarge => ErrorKind::Io,
        _ => ErrorKind::CannotCreate,
    };
    let (name, way_out) = (path.display(), disk::way_out_of_writing(cause));
    Failure::new(kind, format!("cannot write {name}: {cause}{way_out}"))
}
