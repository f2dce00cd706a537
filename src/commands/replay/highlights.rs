//! Creates missing highlights recordings.

use std::path::{Path, PathBuf};

use tempfile::TempDir;
use xcscr::ErrorKind;
use xcscr::record::RecordingKind;
use xcscr::record::reader::Recording;
use xcscr::run::RunFolder;

use crate::commands::failure::Failure;
use crate::commands::source::recordings;

/// Files of runs, including highlights recordings in temporary folders for runs that have none.
pub struct WithHighlights {
    /// All files.
    pub files: Vec<PathBuf>,
    /// Temporary folders, removed on drop.
    _temporary: Vec<TempDir>,
}

/// Writes the highlights of each finished run among `paths` that has none.
pub fn write_missing(
    paths: &[PathBuf],
    mut files: Vec<PathBuf>,
) -> Result<WithHighlights, Failure> {
    let mut written = Vec::new();
    let unwritten = &Failure::system("write a temporary file");
    for path in paths
        .iter()
        .filter(|path| path.join("rules.json").is_file())
    {
        let folder = RunFolder::open(path);
        let has_highlights = path.join(RecordingKind::Highlights.file_name()).is_file();
        if has_highlights || folder.is_interrupted() || folder.plan()?.maze.is_too_large() {
            continue;
        }
        let place = tempfile::tempdir().map_err(unwritten)?;
        let file = place.path().join(RecordingKind::Highlights.file_name());
        std::fs::write(&file, folder.highlights()?).map_err(unwritten)?;
        files.push(file);
        written.push(place);
    }
    Ok(WithHighlights {
        files,
        _temporary: written,
    })
}

/// Reads a recording, or the highlights of a run. Missing highlights are created.
pub fn recording(path: &Path) -> Result<Recording, Failure> {
    if !path.is_dir() {
        return Ok(Recording::open(path)?);
    }
    let with_highlights = write_missing(&[path.to_owned()], recordings(path)?)?;
    let is_highlights = |file: &&PathBuf| file.ends_with(RecordingKind::Highlights.file_name());
    let found = with_highlights.files.iter().find(is_highlights);
    let file = found.ok_or_else(|| {
        let path = path.display();
        let message = format!("{path} has no highlights; give one of its recordings (ep-....mcap)");
        Failure::new(ErrorKind::Missing, message)
    })?;
    Ok(Recording::open(file)?)
}
