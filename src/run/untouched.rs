//! Checks that the folder of an interrupted run was not changed by hand.

use std::io;

use super::contents::{RULES, is_of_a_run};
use super::error::RunFolderError;
use super::folder::RunFolder;
use crate::agent::Knowledge;
use crate::disk;
use crate::record;
use crate::trial::Plan;

impl RunFolder {
    /// Rejects resuming a run if its settings or world were changed, or if the run would replace a
    /// file that no run wrote.
    ///
    /// # Errors
    /// [`RunFolderError::Changed`] if the settings or the world differ from the checkpoint.
    /// [`RunFolderError::InTheWay`] for a foreign file. An error of the file system.
    pub(super) fn check_untouched(&self, plan: &Plan) -> Result<(), RunFolderError> {
        for (name, text) in Self::texts_of(plan) {
            let found = self.bytes_of(name)?;
            if found.is_some_and(|found| found != text.as_bytes()) {
                return Err(RunFolderError::Changed(self.path().join(name)));
            }
        }
        match self.foreign_file()? {
            Some(name) => Err(RunFolderError::InTheWay(self.path().join(name))),
            None => Ok(()),
        }
    }

    /// Returns the first file that has the name of a result of this run but was not written by a
    /// run.
    fn foreign_file(&self) -> Result<Option<String>, RunFolderError> {
        let rules = self.bytes_of(RULES)?;
        if rules.is_some_and(|text| serde_json::from_slice::<Knowledge>(&text).is_err()) {
            return Ok(Some(RULES.to_owned()));
        }
        for name in self.names()? {
            let path = self.path().join(&name);
            let is_written = is_of_a_run(&name) && name.ends_with(".mcap");
            let is_ours =
                !is_written || record::is_ours(&path).map_err(RunFolderError::io(&path))?;
            if !is_ours {
                return Ok(Some(name));
            }
        }
        Ok(None)
    }

    fn bytes_of(&self, name: &str) -> Result<Option<Vec<u8>>, RunFolderError> {
        let path = self.path().join(name);
        match disk::read(&path, disk::MOST_BYTES) {
            Ok(bytes) => Ok(Some(bytes)),
            Err(cause) if cause.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(cause) => Err(RunFolderError::io(&path)(cause)),
        }
    }
}
