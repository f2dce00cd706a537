//! The folder of a planned study, which is run in tasks.

use std::ffi::OsString;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use crate::disk;
use crate::study::error::StudyError;
use crate::study::protocol::{Protocol, id_of};
use crate::study::runner::write_merged;
use crate::study::store::files::{TASKS, foreign, frozen, json, names, parse_frozen};
use crate::study::store::folder::StudyFolder;
use crate::study::store::journal::{self, Journal};
use crate::study::store::{Shard, TrialRecord};
use crate::trial::PlanError;
use xcs::bounds::within;

/// The journals of all attempts at all tasks.
const JOURNALS: &str = "journals";
/// The default folder of the merged study.
const RESULT: &str = "result";
/// More tasks than any cluster engine accepts at once.
const MOST_TASKS: usize = 100_000;

/// The contents of `tasks.json`.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct TasksFile {
    plan: String,
    tasks: usize,
    /// The checksum of the plan and the number of tasks.
    checksum: String,
    study: Box<RawValue>,
}

/// Protects the number of tasks, which is not part of the study's id.
fn checksum(plan: &str, tasks: usize) -> String {
    id_of(&format!("{plan} in {tasks} tasks"))
}

/// A frozen study that is split into tasks, for any number of machines. Task `i` of `n` has every
/// `n`-th trial. `n` is stored in the plan, and nowhere else.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedStudy {
    path: PathBuf,
    protocol: Protocol,
    plan: String,
    tasks: usize,
}

impl PlannedStudy {
    /// Splits a study into tasks. Does not create the folder.
    ///
    /// # Errors
    /// When there are more tasks than trials.
    pub fn new(path: &Path, protocol: Protocol, tasks: usize) -> Result<Self, StudyError> {
        let most = MOST_TASKS.min(protocol.len());
        within("tasks", tasks, 1..=most).map_err(PlanError::from)?;
        Ok(Self {
            path: path.to_owned(),
            plan: protocol.id(),
            protocol,
            tasks,
        })
    }

    /// Returns the study as planned in its folder, or a new one if the folder has none. Without
    /// `tasks`, the number in the folder is used.
    ///
    /// # Errors
    /// [`StudyError::Foreign`], [`StudyError::OtherStudy`] or [`StudyError::OtherTasks`] when the
    /// folder contains something else. [`StudyError::NoTasks`] when the folder is new and `tasks`
    /// is `None`.
    pub fn in_folder(
        path: &Path,
        protocol: Protocol,
        tasks: Option<usize>,
    ) -> Result<Self, StudyError> {
        if !Self::is_in(path) {
            require_own(path)?;
            let tasks = tasks.ok_or_else(|| StudyError::NoTasks(path.to_owned()))?;
            return Self::new(path, protocol, tasks);
        }
        let (folder, found) = (path.to_owned(), Self::read(path)?);
        match (protocol.id(), tasks.unwrap_or(found.tasks)) {
            (wanted, _) if wanted != found.plan => Err(StudyError::OtherStudy {
                folder,
                found: found.plan,
                wanted,
            }),
            (_, wanted) if wanted != found.tasks => Err(StudyError::OtherTasks {
                folder,
                found: found.tasks,
                wanted,
            }),
            _ => Ok(found),
        }
    }

    /// Returns true if the folder contains a planned study.
    pub fn is_in(path: &Path) -> bool {
        path.join(TASKS).is_file()
    }

    /// Reads the folder of a planned study.
    ///
    /// # Errors
    /// When the folder contains no planned study, or a damaged one.
    pub fn read(path: &Path) -> Result<Self, StudyError> {
        let file = path.join(TASKS);
        let text = disk::read(&file, disk::MOST_BYTES).map_err(|cause| match cause.kind() {
            ErrorKind::NotFound => StudyError::NotPlanned(path.to_owned()),
            _ => StudyError::io(&file, cause),
        })?;
        let read: TasksFile =
            serde_json::from_slice(&text).map_err(|fault| StudyError::damaged(&file, fault))?;
        let protocol = parse_frozen(&read.study, &read.plan);
        let protocol = protocol.map_err(|fault| StudyError::damaged(&file, fault))?;
        within("tasks", read.tasks, 1..=protocol.len())
            .map_err(|fault| StudyError::damaged(&file, fault))?;
        if read.checksum != checksum(&read.plan, read.tasks) {
            let fault = "the number of tasks was changed after it was frozen";
            return Err(StudyError::damaged(&file, fault));
        }
        Ok(Self {
            path: path.to_owned(),
            protocol,
            plan: read.plan,
            tasks: read.tasks,
        })
    }

    /// Creates the folder, unless it exists.
    ///
    /// # Errors
    /// [`StudyError::Foreign`], [`StudyError::OtherStudy`] or [`StudyError::OtherTasks`] when the
    /// folder contains something else, or an error of the file system.
    pub fn make(&self) -> Result<(), StudyError> {
        require_own(&self.path)?;
        let journals = self.journals();
        fs::create_dir_all(&journals).map_err(|cause| StudyError::create(&journals, cause))?;
        if !Self::is_in(&self.path) {
            self.write()?;
        }
        // Another process may have made another plan in the meantime.
        Self::in_folder(&self.path, self.protocol.clone(), Some(self.tasks)).map(drop)
    }

    /// Writes the plan, unless it exists.
    fn write(&self) -> Result<(), StudyError> {
        let (study, plan) = frozen(&self.protocol);
        let file = TasksFile {
            checksum: checksum(&plan, self.tasks),
            plan,
            tasks: self.tasks,
            study,
        };
        let path = self.path.join(TASKS);
        match disk::write(&path, &json(&file), false) {
            Err(cause) if cause.kind() != ErrorKind::AlreadyExists => {
                Err(StudyError::io(&path, cause))
            }
            _ => Ok(()),
        }
    }

    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the frozen study.
    pub fn protocol(&self) -> &Protocol {
        &self.protocol
    }

    /// Returns the id of the frozen study.
    pub fn plan(&self) -> &str {
        &self.plan
    }

    /// Returns the number of tasks.
    pub fn tasks(&self) -> usize {
        self.tasks
    }

    /// Returns the default folder of the merged study.
    pub fn result(&self) -> PathBuf {
        self.path.join(RESULT)
    }

    /// Returns the task of a trial, counted from 1.
    pub(super) fn task_of(&self, trial: usize) -> usize {
        trial % self.tasks + 1
    }

    fn journals(&self) -> PathBuf {
        self.path.join(JOURNALS)
    }

    /// Starts a new journal for an attempt at a task.
    pub(super) fn begin(&self, task: usize) -> Result<Journal, StudyError> {
        let folder = self.journals();
        let mut builder = tempfile::Builder::new();
        let prefix = format!("{task:05}-");
        builder.prefix(&prefix).rand_bytes(10);
        // Temporary files are readable only by their owner; make this one as readable as other
        // files.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let made = builder.tempfile_in(&folder);
        let made = made.map_err(|cause| StudyError::io(&folder, cause))?;
        let (file, path) = made
            .keep()
            .map_err(|fault| StudyError::io(&folder, fault.error))?;
        Journal::begin(&path, file, &self.plan)
    }

    /// Calls `each` with each finished trial, in no particular order. A trial that several attempts
    /// finished is passed several times. With a shard, reads only the attempts at its task.
    pub(super) fn each_record(
        &self,
        shard: Option<Shard>,
        each: &mut dyn FnMut(&Path, TrialRecord) -> Result<(), StudyError>,
    ) -> Result<(), StudyError> {
        for (task, path) in self.attempts()? {
            if shard.is_none_or(|shard| shard.number() == task) {
                journal::read(&path, &self.plan, &mut |record| {
                    let fault = record.check(&self.protocol);
                    fault.map_err(|fault| StudyError::damaged(&path, fault))?;
                    each(&path, record)
                })?;
            }
        }
        Ok(())
    }

    /// Returns the journals of all attempts with their tasks, sorted.
    pub(super) fn attempts(&self) -> Result<Vec<(usize, PathBuf)>, StudyError> {
        let folder = self.journals();
        let io = |cause| StudyError::io(&folder, cause);
        let mut found = Vec::new();
        for entry in folder.read_dir().map_err(io)? {
            let name = entry.map_err(io)?.file_name();
            // Ignore other files, such as those of a network file system.
            let task = name.to_str().and_then(|name| name.split_once('-'));
            match task.map(|(task, _)| task.parse()) {
                Some(Ok(task)) if (1..=self.tasks).contains(&task) => {
                    found.push((task, folder.join(name)));
                }
                _ => {}
            }
        }
        found.sort();
        Ok(found)
    }

    /// Merges the results of all attempts, which must be the whole study, into the folder `out`.
    ///
    /// # Errors
    /// [`StudyError::Incomplete`], [`StudyError::Contradiction`] when two attempts disagree about a
    /// trial, or an error of a folder.
    pub fn merge(&self, out: &Path) -> Result<StudyFolder, StudyError> {
        write_merged(&self.gather()?, out)
    }

    /// Collects the results of all attempts.
    pub(in crate::study) fn gather(&self) -> Result<StudyFolder, StudyError> {
        let mut joined = StudyFolder::empty(&self.path, &self.protocol, &self.plan);
        self.each_record(None, &mut |path, record| {
            let trial = record.trial;
            joined
                .records_mut()
                .insert(&record)
                .map_err(|_| StudyError::Contradiction {
                    place: path.to_owned(),
                    trial,
                    before: "an earlier journal",
                })
        })?;
        Ok(joined)
    }
}

/// A folder without a plan may contain files that are created before the plan, and nothing else.
fn require_own(path: &Path) -> Result<(), StudyError> {
    let is_early = |name: &OsString| name == JOURNALS || disk::is_leftover_of(name, TASKS);
    // List the names first: another process may be creating the same plan, and more files after it.
    match names(path)?.iter().all(is_early) || PlannedStudy::is_in(path) {
        true => Ok(()),
        false => Err(foreign(path)),
    }
}
