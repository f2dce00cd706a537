//! `xcscr recording info`: summarises runs and recordings.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Serialize;
use xcscr::record::reader::{Recording, TopicInfo};

use super::summary;
use crate::commands::failure::Failure;
use crate::commands::output::print_json;
use crate::commands::results::{Results, Unwritten};
use crate::commands::source::{all_recordings, recordings};

/// Prints a summary of each run, and the content of each recording.
pub fn run(paths: &[PathBuf], json: bool, out: &mut Results) -> Result<(), Failure> {
    if !json {
        return paths.iter().try_for_each(|path| show(path, out));
    }
    let files = all_recordings(paths)?.into_iter();
    let shown: Vec<Shown> = files
        .map(|file| Shown::of(&file))
        .collect::<Result<_, _>>()?;
    print_json(&shown, out)
}

/// The content of a recording.
#[derive(Debug, Serialize)]
struct Shown {
    file: String,
    run: BTreeMap<String, String>,
    topics: Vec<TopicInfo>,
}

impl Shown {
    fn of(file: &Path) -> Result<Self, Failure> {
        let recording = Recording::open(file)?;
        Ok(Self {
            file: file.display().to_string(),
            run: recording.metadata("run").cloned().unwrap_or_default(),
            topics: recording.topics(),
        })
    }

    fn print(&self, out: &mut Results) -> Result<(), Unwritten> {
        writeln!(out, "{}", self.file)?;
        for (key, value) in &self.run {
            writeln!(out, "  {key:9} {value}")?;
        }
        for topic in &self.topics {
            writeln!(
                out,
                "  {:16} {:6} {}",
                topic.name, topic.messages, topic.schema
            )?;
        }
        Ok(())
    }
}

/// Summarises a run, or lists the content of recordings.
fn show(path: &Path, out: &mut Results) -> Result<(), Failure> {
    let files = recordings(path)?;
    if let Some(run) = summary::whole_run(path) {
        return summary::print(path, &run, &files, out);
    }
    files
        .iter()
        .try_for_each(|file| Ok(Shown::of(file)?.print(out)?))
}
