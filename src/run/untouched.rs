//! Checks that the folder of an interrupted run was not changed by hand.

use std::io;

use super::contents::{RULES, is_of_a_run};
use super::folder::RunFolder;
use crate::agent::Knowledge;
use crate::disk;
use crate::record;
use crate::trial::Plan;
use crate::{Error, ErrorKind};

impl RunFolder {
    /// Rejects resuming a run if its settings or world were changed, or if the run would replace a
    /// file that no run wrote.
    ///
    /// # Errors
    /// If the settings or the world differ from those of the beginning, or a foreign file would be replaced.
    pub(super) fn check_untouched(&self, plan: &Plan) -> Result<(), Error> {
        for (name, text) in Self::texts_of(plan) {
            let found = self.bytes_of(name)?;
            if found.is_some_and(|found| found != text.as_bytes()) {
                let message = format!(
                    "{} was changed since the run began, and a resumed run keeps its settings and world: \
                     remove the file to resume as the run began, or begin a new run",
                    self.path().join(name).display()
                );
                return Err(ErrorKind::BadData.error(message));
            }
        }
        match self.foreign_file()? {
            Some(name) => {
                let message = format!(
                    "{} is not a file of this run, and resuming would replace it: move it away first",
                    self.path().join(name).display()
                );
                Err(ErrorKind::CannotCreate.error(message))
            }
            None => Ok(()),
        }
    }

    /// Returns the first file that has the name of a result of this run but was not written by a
    /// run.
    fn foreign_file(&self) -> Result<Option<String>, Error> {
        let rules = self.bytes_of(RULES)?;
        if rules.is_some_and(|text| serde_json::from_slice::<Knowledge>(&text).is_err()) {
            return Ok(Some(RULES.to_owned()));
        }
        for name in self.names()? {
            let path = self.path().join(&name);
            let is_written = is_of_a_run(&name) && name.ends_with(".mcap");
            let is_ours =
                !is_written || record::is_ours(&path).map_err(disk::cannot_read(&path))?;
            if !is_ours {
                return Ok(Some(name));
            }
        }
        Ok(None)
    }

    fn bytes_of(&self, name: &str) -> Result<Option<Vec<u8>>, Error> {
        let path = self.path().join(name);
        match disk::read(&path, disk::MOST_BYTES) {
            Ok(bytes) => Ok(Some(bytes)),
            Err(cause) if cause.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(cause) => Err(disk::cannot_read(&path)(cause)),
        }
    }
}
