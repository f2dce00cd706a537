//! `xcscr replay --html`: writes a page that plays a recording, a run, or the best trial of a study.

use std::path::{Path, PathBuf};

use xcscr::ErrorKind;
use xcscr::record::reader::Recording;
use xcscr::replay::player;
use xcscr::run::{self, RunFolder};
use xcscr::study::StudyFolder;

use crate::commands::failure::Failure;
use crate::commands::output::OutputFile;
use crate::commands::results::Results;
use crate::commands::terminal::{file_link, shows_links, write_link};

/// Writes the page to `file` and prints its address.
pub fn write(
    paths: &[PathBuf],
    file: &Path,
    force: bool,
    out: &mut Results,
) -> Result<(), Failure> {
    let output = OutputFile::free(file, force)?;
    let [path] = paths else {
        let message = "`--html` takes one recording, run or study";
        return Err(Failure::new(ErrorKind::Usage, message.to_owned()));
    };
    let page = page_of(path, out)?;
    output.write(page.as_bytes())?;
    let link = file_link(file);
    match shows_links() {
        true => write_link("", &link, out)?,
        // Programs read the address.
        false => writeln!(out, "{link}")?,
    }
    Ok(())
}

fn page_of(path: &Path, out: &mut Results) -> Result<String, Failure> {
    if StudyFolder::is_in(path) {
        return page_of_study(&StudyFolder::read(path)?, out);
    }
    if path.is_dir() {
        Ok(RunFolder::open(path).replay_page()?)
    } else {
        let recording = Recording::open(path)?;
        recording.require_single()?;
        Ok(player::page(&recording)?)
    }
}

/// Returns true if a file is the finished recording of an episode of a run, by its name.
pub(super) fn is_episode(file: &Path) -> bool {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    name.starts_with("ep-") && name.ends_with(".mcap")
}

/// Repeats the best trial of a study and returns its page.
fn page_of_study(study: &StudyFolder, out: &mut Results) -> Result<String, Failure> {
    let Some((number, plan)) = study.best_trial()? else {
        let path = study.path().display();
        let message = format!("no trial of the study in {path} reached a goal");
        return Err(Failure::new(ErrorKind::Missing, message));
    };
    let (world, method) = (plan.maze.name(), plan.config.method.name());
    writeln!(
        out,
        "trial {number}: {world}, {method}, seed {}",
        plan.config.seed
    )?;
    Ok(run::page(&plan)?)
}
