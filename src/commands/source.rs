//! Finds recordings.

use std::fs;
use std::path::{Path, PathBuf};

use xcscr::ErrorKind;
use xcscr::disk;

use super::failure::Failure;
use super::terminal::say;

/// Returns the recordings at all paths, in order.
pub fn all_recordings(paths: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
    let files: Vec<Vec<PathBuf>> = paths
        .iter()
        .map(|path| recordings(path))
        .collect::<Result<_, _>>()?;
    Ok(files.concat())
}

/// Returns the recordings at a path: the file itself, or those of a run folder.
pub fn recordings(path: &Path) -> Result<Vec<PathBuf>, Failure> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let unreadable = |cause| {
        Failure::new(
            ErrorKind::Io,
            format!("cannot read {}: {cause}", path.display()),
        )
    };
    let entries: Result<Vec<_>, _> = fs::read_dir(path).map_err(unreadable)?.collect();
    let mut files: Vec<PathBuf> = entries
        .map_err(unreadable)?
        .iter()
        .map(|e| e.path())
        .collect();
    // Unfinished recordings of a stopped run stay in the list, so that the others are not mistaken for the whole run. A
    // running process changes them while they are read.
    let is_running = disk::is_in_use(path);
    let is_recording = |file: &PathBuf| {
        let name = file.to_string_lossy();
        name.ends_with(".mcap") || (name.ends_with(".mcap.part") && !is_running)
    };
    files.retain(is_recording);
    // Sorts episodes by number, because numbers above 9999 have more digits.
    files.sort_by_cached_key(|file| {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        let number: String = name.chars().filter(char::is_ascii_digit).collect();
        (number.is_empty(), number.len(), name.into_owned())
    });
    if is_running {
        let path = path.display();
        say(&format!(
            "note: {path} is in use by another process: only its finished recordings are read"
        ));
    }
    if files.is_empty() {
        let message = format!("{} holds no recordings (.mcap)", path.display());
        return Err(Failure::new(ErrorKind::Missing, message));
    }
    Ok(files)
}
