//! A file that the user asked for by name.

use std::io::{self, ErrorKind};
use std::path::Path;

use xcscr::disk;

use super::failure::{Exit, Failure};

/// A file to write, which is checked before the work for it begins.
#[derive(Debug)]
pub struct OutputFile<'a> {
    path: &'a Path,
    force: bool,
}

impl<'a> OutputFile<'a> {
    /// Fails if the file exists, unless `force` allows to replace it, or if it cannot be written.
    pub fn free(path: &'a Path, force: bool) -> Result<Self, Failure> {
        disk::require_free(path, force)
            .and_then(|()| require_folder(path))
            .map_err(|cause| unwritten(path, &cause))?;
        Ok(Self { path, force })
    }

    /// Writes the file aside, and gives it its name when it is whole.
    pub fn write(&self, bytes: &[u8]) -> Result<(), Failure> {
        disk::write(self.path, bytes, self.force).map_err(|cause| unwritten(self.path, &cause))
    }
}

/// Fails if there is no folder to write the file into.
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
