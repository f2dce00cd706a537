//! `xcscr replay --html`: writes a page that plays a recording, a run, two runs, or the best trial
//! of a study.

use std::io::Write;
use std::path::{Path, PathBuf};

use xcscr::ErrorKind;
use xcscr::record::player;
use xcscr::record::reader::Recording;
use xcscr::record::{Comparison, RecordMode, RecordingKind};
use xcscr::run;
use xcscr::study::{PlannedStudy, StudyFolder};

use super::{browser, highlights};
use crate::commands::failure::Failure;
use crate::commands::output::OutputFile;
use crate::commands::terminal::file_link;

/// Writes the page to `file` and prints its address.
pub fn write(
    paths: &[PathBuf],
    compare: bool,
    (file, force): (&Path, bool),
    open: bool,
    out: &mut impl Write,
) -> Result<(), Failure> {
    let output = OutputFile::free(file, force)?;
    let page = match (paths, compare) {
        ([a, b], true) => of_bytes("comparison.mcap", Comparison::of([a, b])?.bytes)?,
        ([path], false) => page_of(path, out)?,
        _ => {
            let message =
                "`--html` takes one recording, run or study, or with `--compare` two runs";
            return Err(Failure::new(ErrorKind::Usage, message.to_owned()));
        }
    };
    output.write(page.as_bytes())?;
    let link = file_link(file);
    writeln!(out, "{link}")?;
    if open {
        browser::open(&link);
    }
    Ok(())
}

fn page_of(path: &Path, out: &mut impl Write) -> Result<String, Failure> {
    if PlannedStudy::is_in(path) {
        return page_of_study(&StudyFolder::read(path)?, out);
    }
    Ok(player::page(&highlights::recording(path)?)?)
}

/// Repeats the best trial of a study and returns its page.
fn page_of_study(study: &StudyFolder, out: &mut impl Write) -> Result<String, Failure> {
    let Some((number, plan)) = study.best_trial() else {
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
    of_bytes(
        &RecordingKind::Highlights.file_name(),
        run::highlights(&plan, RecordMode::Beams)?,
    )
}

fn of_bytes(name: &str, bytes: Vec<u8>) -> Result<String, Failure> {
    Ok(player::page(&Recording::from_bytes(
        Path::new(name),
        bytes,
    )?)?)
}
