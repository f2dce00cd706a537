//! Creates, opens and replaces the study in a folder.
//!
//! A larger study takes the place of a smaller one when all its trials are finished. Until then the plan and the results
//! of the smaller one stay.

use std::path::Path;

use super::folder::StudyFolder;
use super::journal;
use super::outputs::{is_output, outputs, remove_outputs};
use super::plan::{PLAN, StoredPlan};
use crate::disk::{self, FolderLock, LOCK};
use crate::study::error;
use crate::study::protocol::Protocol;
use crate::study::report::Report;
use crate::{Error, ErrorKind};

impl StudyFolder {
    /// Returns true if the folder contains a study.
    pub fn is_in(path: &Path) -> bool {
        StoredPlan::is_in(path)
    }

    /// Creates the folder of a study that is split into tasks, unless it exists.
    ///
    /// # Errors
    /// When the folder contains something else, another study, or another number of tasks.
    pub fn plan_tasks(path: &Path, protocol: Protocol, tasks: usize) -> Result<Self, Error> {
        let wanted = StoredPlan::new(protocol, tasks)?;
        let found = wanted.create(path)?;
        if found.id != wanted.id {
            return Err(refusal(path, &wanted, &found));
        }
        if found.tasks != tasks {
            return Err(ErrorKind::CannotCreate.error(format!(
                "{} is split into {} tasks, not {tasks}: leave out `--tasks`, or choose \
                 another folder with `--out`",
                path.display(),
                found.tasks
            )));
        }
        Self::of(path, found)
    }

    /// Creates or reopens the folder of a study, and locks it for writing. The folder may contain a smaller
    /// study, which stays there until the larger one is finished. With `force`, another study is replaced, and so are
    /// generated files that were changed by hand.
    ///
    /// # Errors
    /// When the folder is in use or contains something else, or an error of the file system.
    pub fn open(path: &Path, protocol: Protocol, force: bool) -> Result<Self, Error> {
        let wanted = StoredPlan::new(protocol, 1)?;
        wanted.create(path)?;
        let lock = lock(path)?;
        let found = StoredPlan::read(path)?;
        let grows = wanted.extends(&found);
        let plan = if found.id == wanted.id {
            found
        } else if grows {
            let tasks = found.tasks;
            StoredPlan { tasks, ..wanted }
        } else if force {
            clear(path)?;
            // The folder has a plan at any moment, so that it is recognised as the folder of a study.
            wanted.write(path, true)?;
            wanted
        } else {
            return Err(refusal(path, &wanted, &found));
        };
        Ok(Self {
            force,
            grows,
            _lock: Some(lock),
            ..Self::of(path, plan)?
        })
    }

    /// Reads the folder of a study, and locks it for writing.
    ///
    /// # Errors
    /// The same as for [`Self::read`], or [`ErrorKind::CannotCreate`] if another process has the lock.
    pub fn read_locked(path: &Path) -> Result<Self, Error> {
        // No lock file is created in a folder without a study.
        let lock = StoredPlan::is_in(path).then(|| lock(path)).transpose()?;
        Ok(Self {
            _lock: lock,
            ..Self::read(path)?
        })
    }

    /// Checks that the generated files of a smaller study in the folder are as the tables and the report are written
    /// anew. An unfinished study has none, and the tables of episodes cannot be checked without repeating the trials.
    pub(in crate::study) fn require_own_outputs(&self) -> Result<(), Error> {
        let mut present = outputs().filter(|name| self.path.join(name).symlink_metadata().is_ok());
        let Some(first) = present.next().filter(|_| self.grows && !self.force) else {
            return Ok(());
        };
        let fresh = tempfile::tempdir().map_err(error::io(&std::env::temp_dir()))?;
        let smaller = Self {
            path: fresh.path().to_owned(),
            ..Self::read(&self.path)?
        };
        if smaller.missing().is_empty() {
            Report::new(&smaller).write()?;
        }
        let mut changed = Vec::new();
        for name in std::iter::once(first).chain(present) {
            let wanted = disk::read(&fresh.path().join(name), disk::MOST_BYTES).ok();
            let file = self.path.join(name);
            let differs = |wanted: Vec<u8>| disk::differs(&file, &wanted);
            if wanted.map_or(Ok(true), differs).map_err(error::io(&file))? {
                changed.push(name);
            }
        }
        match changed[..] {
            [] => Ok(()),
            _ => Err(ErrorKind::CannotCreate.error(format!(
                "{} has files that were changed by hand, or are from `study episodes` or elsewhere ({}): move them to \
                 another folder, or replace them with `--force`; the trials are kept",
                self.path.display(),
                changed.join(", ")
            ))),
        }
    }

    /// Replaces a smaller study in the folder by this one, which must be complete. The journals stay as they are.
    pub(in crate::study) fn replace_smaller(&mut self) -> Result<(), Error> {
        if self.grows {
            // A file may have been changed while the trials ran.
            self.require_own_outputs()?;
            remove_outputs(&self.path)?;
            self.plan.write(&self.path, true)?;
            self.grows = false;
        }
        Ok(())
    }
}

/// Removes the journals and the generated files of a study, and nothing else.
fn clear(path: &Path) -> Result<(), Error> {
    let journals = journal::all(path)?;
    let mut files = journals.iter();
    files.try_for_each(|file| journal::require_journal(file))?;
    remove_outputs(path)?;
    let mut files = journals.iter();
    files.try_for_each(|file| disk::remove(file).map_err(error::io(file)))
}

/// Returns the error for a folder that contains another plan than the wanted one.
fn refusal(path: &Path, wanted: &StoredPlan, found: &StoredPlan) -> Error {
    let (folder, differences) = (path.display(), wanted.protocol.differences(&found.protocol));
    ErrorKind::CannotCreate.error(if wanted.extends(found) { format!(
            "{folder} contains a smaller study ({differences}): add its trials with `study run`, or choose \
             another folder with `--out`"
        ) } else { format!(
            "{folder} contains another study ({differences}): choose another folder with `--out`, or replace \
             that study with `study run --force`"
        ) })
}

/// Locks a folder, and removes the temporary files that a killed process left in it.
fn lock(folder: &Path) -> Result<FolderLock, Error> {
    let lock = FolderLock::acquire(folder, disk::cannot_create(&folder.join(LOCK)))?;
    let is_ours = |name: &str| name == PLAN || is_output(name);
    disk::remove_leftovers(folder, is_ours).map_err(error::io(folder))?;
    Ok(lock)
}
