//! `xcscr replay --story`: how a run learned, in less than two minutes.

use std::path::{Path, PathBuf};

use tempfile::TempDir;
use xcscr::record::Extent;
use xcscr::run::{RunFolder, Source};

use crate::commands::failure::Failure;
use crate::commands::output::OutputFile;

/// Tells the story of a run, or of the run that a recording comes from, into a file.
pub fn run(run: &Path, output: &Path, force: bool) -> Result<(), Failure> {
    let file = OutputFile::free(output, force)?;
    let story = match run.is_dir() {
        true => RunFolder::open(run).story()?,
        false => Source::of(run)?.story()?,
    };
    file.write(&story)
}

/// Files that may lack a story, and those that were told in their place.
pub struct WithStories {
    /// All files.
    pub files: Vec<PathBuf>,
    /// What goes away with this.
    _told: Vec<TempDir>,
}

/// Tells the story of each of the finished runs among `paths` that lacks one.
pub fn tell_missing(paths: &[PathBuf], mut files: Vec<PathBuf>) -> Result<WithStories, Failure> {
    let mut told = Vec::new();
    for path in paths
        .iter()
        .filter(|path| path.join("rules.json").is_file())
    {
        let folder = RunFolder::open(path);
        let has_story = path.join(Extent::Story.file_name()).is_file();
        if has_story || folder.is_interrupted() || folder.plan()?.maze.is_vast() {
            continue;
        }
        let place = tempfile::tempdir()?;
        let file = place.path().join(Extent::Story.file_name());
        std::fs::write(&file, folder.story()?)?;
        files.push(file);
        told.push(place);
    }
    Ok(WithStories { files, _told: told })
}
