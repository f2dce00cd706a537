//! Verifies that a repeated run produces the same bytes.

use std::fs;
use std::io;

use tempfile::TempDir;

use super::error;
use super::recorded_run::RecordedRun;
use super::run_inputs::RunInputs;
use crate::Error;
use crate::agent::Knowledge;
use crate::episode::Observer;
use crate::record::{self, RecordMode};

/// A repeated run in a temporary folder, which is deleted with this value.
pub struct Repetition {
    pub(super) run: RunInputs,
    mode: RecordMode,
    /// The learned knowledge at the end.
    pub(super) knowledge: Knowledge,
    pub(super) folder: TempDir,
}

impl Repetition {
    /// Repeats the run of a recording, while `observer` watches.
    ///
    /// # Errors
    /// If the settings or the world are invalid, or a file cannot be written.
    pub fn new(source: &RecordedRun, observer: &mut dyn Observer) -> Result<Self, Error> {
        Self::of(source.run.clone(), source.mode, observer)
    }

    /// Repeats and records a run.
    pub(super) fn of(
        run: RunInputs,
        mode: RecordMode,
        observer: &mut dyn Observer,
    ) -> Result<Self, Error> {
        let folder = tempfile::tempdir().map_err(error::temporary)?;
        Ok(Self {
            knowledge: run.record(folder.path(), mode, observer)?,
            run,
            mode,
            folder,
        })
    }

    /// Returns true if another recording comes from the same run.
    pub fn serves(&self, source: &RecordedRun) -> bool {
        self.mode == source.mode && self.run == source.run
    }

    /// Returns the first difference between a recording and that of this run as text.
    ///
    /// # Errors
    /// If one of the two cannot be read.
    pub fn difference(&self, source: &RecordedRun) -> Result<Option<String>, Error> {
        let name = source.extent.file_name();
        let folder = self.folder.path();
        let bytes = match fs::read(folder.join(&name)) {
            Err(cause) if cause.kind() == io::ErrorKind::NotFound => {
                let external = self.run.external.as_ref().map(Vec::len);
                let episodes = external.unwrap_or(self.run.plan.config.episodes as usize);
                let fault = format!("a new run of {episodes} episodes produces no {name}");
                return Ok(Some(fault));
            }
            bytes => bytes.map_err(error::temporary)?,
        };
        record::compare(&source.bytes, &bytes)
    }
}
