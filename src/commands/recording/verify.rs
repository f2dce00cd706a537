//! `xcscr recording verify`: compares recordings with repeated runs byte by byte.

use std::path::{Path, PathBuf};

use xcscr::ErrorKind;
use xcscr::record::reader::Recording;
use xcscr::run::{RecordedRun, Repetition};

use crate::commands::failure::Failure;
use crate::commands::output::print_json;
use crate::commands::progress::EpisodeProgress;
use crate::commands::results::Results;

/// The result for one recording, as `--json` prints it.
#[derive(serde::Serialize)]
struct Verified {
    file: String,
    same: bool,
    /// The first difference from the repeated run.
    difference: Option<String>,
}

/// Verifies all recordings. Recordings of the same run are compared with one repeated run.
pub fn run(files: &[PathBuf], json: bool, out: &mut Results) -> Result<(), Failure> {
    let mut verified = Vec::new();
    let mut again: Option<Repetition> = None;
    for file in files {
        let difference = match difference(file, &mut again) {
            Ok(difference) => difference,
            Err(failure) if failure.kind() == ErrorKind::BadData => Some(failure.to_string()),
            Err(failure) => return Err(failure),
        };
        let same = difference.is_none();
        verified.push(Verified {
            file: file.display().to_string(),
            same,
            difference,
        });
    }
    report(&verified, json, out)
}

/// Returns the first difference between a recording and a repeated run. `again` caches the last
/// repeated run.
fn difference(file: &Path, again: &mut Option<Repetition>) -> Result<Option<String>, Failure> {
    let recording = Recording::open(file)?;
    let source = RecordedRun::of_recording(&recording)?;
    let run = match again.take().filter(|run| run.serves(&source)) {
        Some(run) => run,
        None => {
            let episodes = source.run.plan.config.episodes;
            Repetition::new(&source, &mut EpisodeProgress::of(episodes, false))?
        }
    };
    Ok(again.insert(run).difference(&source)?)
}

fn report(verified: &[Verified], json: bool, out: &mut Results) -> Result<(), Failure> {
    let (same, all) = (verified.iter().filter(|v| v.same).count(), verified.len());
    if json {
        print_json(&verified, out)?;
    } else {
        for Verified {
            file, difference, ..
        } in verified
        {
            if let Some(difference) = difference {
                writeln!(out, "{file}: {difference}")?;
            }
        }
        writeln!(
            out,
            "{same} of {all} recordings are bit-identical to a new run"
        )?;
    }
    if same == all {
        return Ok(());
    }
    let other = all - same;
    let differ = if other == 1 { "differs" } else { "differ" };
    let message = format!("{other} of {all} recordings {differ} from a new run");
    Err(Failure::new(ErrorKind::Refuted, message))
}
