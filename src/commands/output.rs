//! Output files named by the user.

use std::io::{self, ErrorKind};
use std::path::Path;

use xcscr::disk;

use super::failure::{Exit, Failure};

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
            ErrorKind::NotADirectory,
            "there is no such folder; create it first, or choose another",
        )),
        _ => Ok(()),
    }
}

fn unwritten(path: &Path, cause: &io::Error) -> Failure {
    let exit = match cause.kind() {
        ErrorKind::StorageFull | ErrorKind::FileTooLarge => Exit::Io,
        _ => Exit::CannotCreate,
    };
    let (name, way_out) = (path.display(), disk::way_out(cause));
    Failure::new(exit, format!("cannot write {name}: {cause}{way_out}"))
}
