//! The folder of a study.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::files::{JOURNAL, PLAN, insert, read_plan, read_records, write_plan, write_whole};
use super::journal::{self, Journal};
use super::record::TrialRecord;
use crate::disk;
use crate::disk::{FolderLock, LOCK, LockError};
use crate::study::error::StudyError;
use crate::study::protocol::Protocol;

/// What is made of finished trials.
const OUTPUTS: [&str; 12] = [
    "trials.csv",
    "summary.json",
    "report.md",
    "report.html",
    "first-optimal.svg",
    "first-optimal.png",
    "curves.svg",
    "curves.png",
    "steps.svg",
    "steps.png",
    "ablation.svg",
    "ablation.png",
];

/// A folder with a frozen study and its finished trials.
#[derive(Debug)]
pub struct StudyFolder {
    path: PathBuf,
    protocol: Protocol,
    /// The protocol's id, as it was when it was frozen: a newer program may know more settings.
    plan: String,
    records: BTreeMap<usize, TrialRecord>,
    /// May files be replaced that hold something else than the study wrote?
    force: bool,
    /// Held by who writes in the folder.
    _lock: Option<FolderLock>,
}

impl StudyFolder {
    /// Reads the folder of a study.
    ///
    /// # Errors
    /// When there is no study in it, or a damaged one.
    pub fn read(path: &Path) -> Result<Self, StudyError> {
        let (protocol, plan) =
            read_plan(path)?.ok_or_else(|| StudyError::NoStudy(path.to_owned()))?;
        let (records, _) = read_records(path, &protocol, &plan)?;
        Ok(Self {
            path: path.to_owned(),
            protocol,
            plan,
            records,
            force: false,
            _lock: None,
        })
    }

    /// The same folder, in which files are replaced though they hold something else than the
    /// study wrote.
    pub fn replacing(self, force: bool) -> Self {
        Self { force, ..self }
    }

    /// Puts this study in the place of another one in a folder: removes its trials and what was made
    /// of them, and nothing else. A folder with no study, or with this one, is left as it is.
    ///
    /// # Errors
    /// [`StudyError::Locked`], or an error of the file system.
    pub fn replace_other(path: &Path, protocol: &Protocol) -> Result<(), StudyError> {
        let is_other = read_plan(path)?.is_some_and(|(_, found)| found != protocol.id());
        if !is_other {
            return Ok(());
        }
        let _lock = lock(path)?;
        for name in OUTPUTS.into_iter().chain([JOURNAL]) {
            let file = path.join(name);
            disk::remove(&file).map_err(|cause| StudyError::io(&file, cause))?;
        }
        // By its plan the folder is known as that of a study, at any moment.
        write_plan(path, protocol)
    }

    /// Writes something that is made of the trials. A file that holds something else is somebody
    /// else's, or was changed by hand, and stays, unless it may be [replaced](Self::replacing).
    pub(in crate::study) fn write(&self, name: &str, bytes: &[u8]) -> Result<(), StudyError> {
        let path = self.path.join(name);
        let differs = disk::differs(&path, bytes);
        if !self.force && differs.map_err(|cause| StudyError::io(&path, cause))? {
            return Err(StudyError::Exists(path));
        }
        write_whole(&path, bytes)
    }

    /// Reads the folder of a study in order to write in it.
    ///
    /// # Errors
    /// The same, or [`StudyError::Locked`].
    pub fn read_locked(path: &Path) -> Result<Self, StudyError> {
        // Nothing is left in a folder that is none of ours.
        let lock = path.join(PLAN).is_file().then(|| lock(path)).transpose()?;
        let folder = Self::read(path)?;
        Ok(Self {
            _lock: lock,
            ..folder
        })
    }

    /// Joins folders of one study, in any order.
    ///
    /// # Errors
    /// [`StudyError::Mixed`] when their plans differ, [`StudyError::Contradiction`] when they
    /// disagree about a trial, or when a folder cannot be read.
    pub fn join(paths: &[PathBuf]) -> Result<Self, StudyError> {
        let mut folders = paths.iter().map(|path| Self::read(path));
        let mut joined = folders
            .next()
            .unwrap_or(Err(StudyError::NoStudy(PathBuf::new())))?;
        for folder in folders {
            joined.add(folder?)?;
        }
        Ok(joined)
    }

    fn add(&mut self, other: Self) -> Result<(), StudyError> {
        let (ours, theirs) = (self.plan.clone(), other.plan);
        if ours != theirs {
            return Err(StudyError::Mixed(
                self.path.clone(),
                other.path,
                ours,
                theirs,
            ));
        }
        for (trial, record) in other.records {
            insert(&mut self.records, record).map_err(|()| StudyError::Contradiction {
                place: other.path.clone(),
                trial,
                before: "the folders before it",
            })?;
        }
        Ok(())
    }

    /// The frozen study.
    pub fn protocol(&self) -> &Protocol {
        &self.protocol
    }

    /// The id of the frozen study.
    pub fn plan(&self) -> &str {
        &self.plan
    }

    /// Where the folder is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The finished trials, in their order.
    pub fn records(&self) -> impl Iterator<Item = &TrialRecord> {
        self.records.values()
    }

    /// The trials that are not finished, in their order.
    pub fn missing(&self) -> Vec<usize> {
        let trials = 0..self.protocol.len();
        trials
            .filter(|trial| !self.records.contains_key(trial))
            .collect()
    }

    /// The trials that failed.
    pub fn failed(&self) -> Vec<usize> {
        let failed = self.records().filter(|record| record.result.is_err());
        failed.map(|record| record.trial).collect()
    }

    /// Accepts the study when all trials are finished.
    ///
    /// # Errors
    /// [`StudyError::Incomplete`].
    pub fn require_complete(&self) -> Result<(), StudyError> {
        let total = self.protocol.len();
        match self.missing().len() {
            0 => Ok(()),
            missing => Err(StudyError::Incomplete { missing, total }),
        }
    }
}

/// A study folder in which this process, and no other, may write.
#[derive(Debug)]
pub struct OpenFolder {
    folder: StudyFolder,
    journal: Journal,
}

impl OpenFolder {
    /// Makes or reopens the folder of a study.
    ///
    /// # Errors
    /// [`StudyError::Locked`], [`StudyError::OtherStudy`], or an error of the file system.
    pub fn open(path: &Path, protocol: &Protocol) -> Result<Self, StudyError> {
        // Without a lock yet, so that nothing is left in a folder that is none of ours. Another
        // process may be about to begin there: then it has the lock.
        let held = path.join(LOCK);
        let is_free = !held.exists() || disk::is_foreign_lock(&held);
        if is_free && is_foreign(path)? {
            return Err(StudyError::Foreign(path.to_owned()));
        }
        fs::create_dir_all(path).map_err(|cause| StudyError::create(path, cause))?;
        let lock = lock(path)?;
        let wanted = protocol.id();
        match read_plan(path)? {
            None if is_foreign(path)? => return Err(StudyError::Foreign(path.to_owned())),
            None => write_plan(path, protocol)?,
            Some((_, found)) if found == wanted => (),
            Some((_, found)) => {
                let folder = path.to_owned();
                return Err(StudyError::OtherStudy {
                    folder,
                    found,
                    wanted,
                });
            }
        }
        let (records, whole) = read_records(path, protocol, &wanted)?;
        let journal = Journal::open(&path.join(JOURNAL), &wanted, whole)?;
        let folder = StudyFolder {
            path: path.to_owned(),
            protocol: protocol.clone(),
            plan: wanted,
            records,
            force: false,
            _lock: Some(lock),
        };
        Ok(Self { folder, journal })
    }

    /// What is in the folder.
    pub fn folder(&self) -> &StudyFolder {
        &self.folder
    }

    /// Keeps finished trials.
    ///
    /// # Errors
    /// An error of the file system.
    pub fn add(&mut self, records: Vec<TrialRecord>) -> Result<(), StudyError> {
        self.journal.append(&records)?;
        let numbered = records.into_iter().map(|record| (record.trial, record));
        self.folder.records.extend(numbered);
        Ok(())
    }

    /// Keeps all trials of a joined study.
    ///
    /// # Errors
    /// [`StudyError::Contradiction`] when it holds another result of one, or an error of the file
    /// system.
    pub fn add_all(&mut self, joined: &StudyFolder) -> Result<(), StudyError> {
        let known = &self.folder.records;
        let mut missing = Vec::new();
        for record in joined.records() {
            match known.get(&record.trial) {
                Some(one) if one != record => {
                    return Err(StudyError::Contradiction {
                        place: self.folder.path.clone(),
                        trial: record.trial,
                        before: "the folders that are to be joined in it",
                    });
                }
                Some(_) => {}
                None => missing.push(record.clone()),
            }
        }
        self.add(missing)
    }

    /// Puts the journal in order. The folder stays locked as long as it is held.
    ///
    /// # Errors
    /// An error of the file system.
    pub fn close(self) -> Result<StudyFolder, StudyError> {
        let Self { folder, journal } = self;
        drop(journal);
        let records: Vec<TrialRecord> = folder.records().cloned().collect();
        let text = journal::text(&folder.plan, &records);
        write_whole(&folder.path.join(JOURNAL), text.as_bytes())?;
        Ok(folder)
    }
}

/// Are there files, but no plan of a study?
fn is_foreign(path: &Path) -> Result<bool, StudyError> {
    let names = path.read_dir().and_then(|entries| {
        let names = entries.map(|entry| Ok(entry?.file_name()));
        names.collect::<io::Result<Vec<_>>>()
    });
    let names = match names {
        Err(cause) if cause.kind() == io::ErrorKind::NotFound => return Ok(false),
        names => names.map_err(|cause| StudyError::create(path, cause))?,
    };
    // What is there before the plan.
    let part = disk::part(Path::new(PLAN));
    let is_lock = |name: &OsString| name == LOCK && !disk::is_foreign_lock(&path.join(LOCK));
    let is_early = |name: &OsString| is_lock(name) || name == part.as_os_str();
    Ok(!names.iter().any(|name| name == PLAN) && !names.iter().all(is_early))
}

fn lock(folder: &Path) -> Result<FolderLock, StudyError> {
    FolderLock::acquire(folder).map_err(|fault| match fault {
        LockError::Held(pid) => StudyError::Locked {
            folder: folder.to_owned(),
            holder: pid.map_or("another process".to_owned(), |pid| format!("process {pid}")),
        },
        LockError::File(path, cause) => StudyError::create(&path, cause),
    })
}
