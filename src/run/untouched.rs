//! Is the folder of an interrupted run as the run left it?

use std::io;

use super::error::RunFolderError;
use super::folder::RunFolder;
use crate::agent::Knowledge;
use crate::disk;
use crate::record;
use crate::trial::Plan;

impl RunFolder {
    /// Refuses to resume a run where somebody changed what it works with, or where the run would
    /// write over a file that it did not write.
    ///
    /// # Errors
    /// [`RunFolderError::Changed`] for settings or a world that are not those of the checkpoint;
    /// [`RunFolderError::InTheWay`] for a file of others; an error of the file system.
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

    /// Returns the first file that has a name of this run's results and is none.
    fn foreign_file(&self) -> Result<Option<String>, RunFolderError> {
        let rules = self.bytes_of(Self::RULES)?;
        if rules.is_some_and(|text| serde_json::from_slice::<Knowledge>(&text).is_err()) {
            return Ok(Some(Self::RULES.to_owned()));
        }
        for name in self.names()? {
            let path = self.path().join(&name);
            let is_written = Self::writes(&name) && name.ends_with(".mcap");
            let is_ours = !is_written
                || record::is_ours(&path).map_err(|cause| RunFolderError::Io { path, cause })?;
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
            Err(cause) => Err(RunFolderError::Io { path, cause }),
        }
    }
}
