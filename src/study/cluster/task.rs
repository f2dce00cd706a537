//! An attempt at a task.

use super::planned::PlannedStudy;
use super::survey::Survey;
use crate::study::error::StudyError;
use crate::study::own::Agents;
use crate::study::runner::{StudyWatcher, run_trials};
use crate::study::store::Shard;

impl PlannedStudy {
    /// Runs the missing trials of a task, counted from 1, on `jobs` threads (all cores when 0).
    /// Returns the progress of the task, and the number of trials finished by this call.
    ///
    /// # Errors
    /// When there is no such task, another version of the program made the plan, or the folder
    /// cannot be read or written.
    pub fn run_task(
        &self,
        task: usize,
        jobs: usize,
        watcher: &mut dyn StudyWatcher,
    ) -> Result<(Survey, usize), StudyError> {
        let (count, folder) = (self.tasks(), self.path().to_owned());
        let shard = Shard::nth(task, count).ok_or(StudyError::NoTask {
            folder,
            task,
            count,
        })?;
        self.require_same_program()?;
        let before = Survey::of(self, Some(shard))?;
        if before.missing().is_empty() {
            watcher.begins(0);
            return Ok((before, 0));
        }
        let mut journal = self.begin(task)?;
        run_trials(
            (self.protocol(), &Agents::default()),
            before.missing(),
            jobs,
            &mut journal,
            watcher,
        )?;
        let after = Survey::of(self, Some(shard))?;
        let finished = before.missing().len() - after.missing().len();
        Ok((after, finished))
    }

    /// Another version may compute other results, or have other settings.
    fn require_same_program(&self) -> Result<(), StudyError> {
        match self.protocol().version == env!("CARGO_PKG_VERSION") {
            true => Ok(()),
            false => Err(StudyError::OtherVersion {
                folder: self.path().to_owned(),
                found: self.protocol().version.clone(),
            }),
        }
    }
}
