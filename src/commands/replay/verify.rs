//! `xcscr replay --verify`: whether a new run gives the same bytes.

use std::fs;
use std::io::Write;
use std::path::PathBuf;

use xcscr::record::{self, RecordMode};
use xcscr::trial::{Plan, Trial};

use crate::commands::failure::{Exit, Failure};
use crate::commands::progress::Progress;
use crate::commands::source::Source;
use crate::commands::train;

/// What became of one recording, as `--json` prints it.
#[derive(serde::Serialize)]
struct Verified {
    file: String,
    same: bool,
    /// The first difference from the run that was made again.
    difference: Option<String>,
}

/// Verifies all recordings; those of the same run are compared with one new run.
pub fn run(files: &[PathBuf], json: bool, out: &mut impl Write) -> Result<(), Failure> {
    let mut verified = Vec::new();
    let mut again: Option<Again> = None;
    for file in files {
        let difference = match Source::of(file) {
            Ok(source) => {
                if again.as_ref().is_none_or(|run| !run.serves(&source)) {
                    again = Some(Again::new(&source)?);
                }
                let run = again.as_ref().expect("a run was just made");
                run.difference(&source)?
            }
            Err(failure) if failure.exit == Exit::BadData => Some(failure.to_string()),
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

fn report(verified: &[Verified], json: bool, out: &mut impl Write) -> Result<(), Failure> {
    let (same, all) = (verified.iter().filter(|v| v.same).count(), verified.len());
    if json {
        writeln!(out, "{}", serde_json::to_string_pretty(verified)?)?;
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
            "{same} of {all} recordings are the same as a new run, to the bit"
        )?;
    }
    if same == all {
        return Ok(());
    }
    let message = format!("{} of {all} recordings differ from a new run", all - same);
    Err(Failure::new(Exit::Refuted, message))
}

/// A trial that was run again, into a folder that goes away afterwards.
struct Again {
    plan: Plan,
    mode: RecordMode,
    folder: tempfile::TempDir,
}

impl Again {
    fn new(source: &Source) -> Result<Self, Failure> {
        let plan = &source.plan;
        let folder = tempfile::tempdir().map_err(|cause| {
            Failure::new(
                Exit::CannotCreate,
                format!("cannot make a temporary folder: {cause}"),
            )
        })?;
        let mut trial = Trial::new(plan.clone())?;
        let recorder = train::recorder(folder.path(), plan, source.mode)?;
        train::train(
            &mut trial,
            recorder,
            Progress::new(plan.config.episodes, false),
        )?;
        Ok(Self {
            plan: plan.clone(),
            mode: source.mode,
            folder,
        })
    }

    fn serves(&self, source: &Source) -> bool {
        self.mode == source.mode && self.plan == source.plan
    }

    /// The first difference between a recording and that of this run.
    fn difference(&self, source: &Source) -> Result<Option<String>, Failure> {
        let name = match source.episode {
            None => "run.mcap".to_owned(),
            Some(episode) => format!("ep-{episode:04}.mcap"),
        };
        let Ok(bytes) = fs::read(self.folder.path().join(&name)) else {
            let episodes = self.plan.config.episodes;
            return Ok(Some(format!(
                "a new run of {episodes} episodes makes no {name}"
            )));
        };
        let difference = record::compare(&source.bytes, &bytes)?;
        Ok(difference.map(|difference| difference.to_string()))
    }
}
