//! The plan of a study in its folder: the frozen study, and the number of its tasks.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::earlier::EarlierPlan;
use super::journal::{self, Journal};
use crate::disk;
use crate::study::error;
use crate::study::protocol::{Protocol, id_of};
use crate::{Error, ErrorKind};
use xcs::bounds::within;

/// The file of the plan.
pub const PLAN: &str = "study.json";
/// The folder of the journals.
const JOURNALS: &str = "journals";
/// More tasks than any cluster engine accepts at once.
const MOST_TASKS: usize = 100_000;

/// The contents of `study.json`.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PlanFile {
    /// The checksum of the study's text.
    plan: String,
    tasks: usize,
    /// The checksum of the plan, the number of tasks and the earlier plans.
    checksum: String,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    earlier: Vec<EarlierPlan>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    replaced: BTreeMap<String, u32>,
    study: Box<RawValue>,
}

/// Protects the number of tasks and the earlier plans, which are not part of the study's id.
fn checksum(plan: &str, tasks: usize, earlier: &[EarlierPlan]) -> String {
    let earlier = match earlier {
        [] => String::new(),
        some => serde_json::to_string(some).expect("plain data becomes JSON"),
    };
    id_of(&format!("{plan} in {tasks} tasks{earlier}"))
}

/// A frozen study that is split into tasks, for any number of processes and machines. Task `i` of
/// `n` has every `n`-th trial. `n` is stored in the plan, and nowhere else.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedStudy {
    path: PathBuf,
    protocol: Protocol,
    /// The id of the frozen protocol, as stored. A newer program may have more settings, and so
    /// another id.
    plan: String,
    tasks: usize,
    earlier: Vec<EarlierPlan>,
    /// The generated files of the smaller study that this one replaces, by name, with the checksums of their
    /// contents. Empty when they are removed.
    pub(in crate::study) replaced: BTreeMap<String, u32>,
}

impl PlannedStudy {
    /// Splits a study into tasks. Does not create the folder.
    ///
    /// # Errors
    /// When there are no trials, or more tasks than trials.
    pub fn new(path: &Path, protocol: Protocol, tasks: usize) -> Result<Self, Error> {
        if protocol.is_empty() {
            let fault = format!("the study `{}` has no methods: list some", protocol.name);
            return Err(ErrorKind::BadData.error(fault));
        }
        let most = MOST_TASKS.min(protocol.len());
        within("tasks", tasks, 1..=most)?;
        Ok(Self {
            path: path.to_owned(),
            plan: protocol.id(),
            protocol,
            tasks,
            earlier: Vec::new(),
            replaced: BTreeMap::new(),
        })
    }

    /// Returns this study with the trials, methods and worlds that `protocol` adds, and with its
    /// reference method. `None` if `protocol` does not have all trials of this study, or is the same.
    pub(super) fn extended(&self, protocol: &Protocol) -> Option<Self> {
        let places = protocol.extends(&self.protocol)?;
        let mut earlier: Vec<_> = self.earlier.iter().map(|one| one.moved(&places)).collect();
        earlier.push(EarlierPlan::new(&self.plan, &self.protocol, &places));
        Some(Self {
            path: self.path.clone(),
            plan: protocol.id(),
            protocol: protocol.clone(),
            tasks: self.tasks,
            earlier,
            replaced: BTreeMap::new(),
        })
    }

    /// Returns the earlier plans, to which trials, methods or worlds were added.
    pub(super) fn earlier(&self) -> &[EarlierPlan] {
        &self.earlier
    }

    /// Returns the study as planned in its folder, or a new one if the folder has none. Without
    /// `tasks`, the number in the folder is used.
    ///
    /// # Errors
    /// When the folder contains something else, or is new and `tasks` is `None`.
    pub fn in_folder(path: &Path, protocol: Protocol, tasks: Option<usize>) -> Result<Self, Error> {
        let folder = path.display();
        if !Self::is_in(path) {
            require_own(path)?;
            let tasks = tasks.ok_or_else(|| {
                let fault =
                    format!("{folder} is new: give the number of tasks, such as `--tasks 100`");
                ErrorKind::Usage.error(fault)
            })?;
            return Self::new(path, protocol, tasks);
        }
        let found = Self::read(path)?;
        match (protocol.id(), tasks.unwrap_or(found.tasks)) {
            (wanted, _) if wanted != found.plan && found.extended(&protocol).is_some() => {
                Err(ErrorKind::CannotCreate.error(format!(
                    "{folder} contains a smaller study ({}): add its trials with `study run`, or choose \
                     another folder with `--out`",
                    protocol.differences(&found.protocol)
                )))
            }
            (wanted, _) if wanted != found.plan => Err(ErrorKind::CannotCreate.error(format!(
                "{folder} contains another study ({}): choose another folder with `--out`, or replace \
                 that study with `study run --force`",
                protocol.differences(&found.protocol)
            ))),
            (_, wanted) if wanted != found.tasks => Err(ErrorKind::CannotCreate.error(format!(
                "{folder} is split into {} tasks, not {wanted}: leave out `--tasks`, or choose \
                 another folder with `--out`",
                found.tasks
            ))),
            _ => Ok(found),
        }
    }

    /// Returns true if the folder contains a study.
    pub fn is_in(path: &Path) -> bool {
        path.join(PLAN).is_file()
    }

    /// Reads the plan in the folder of a study.
    ///
    /// # Errors
    /// When the folder contains no study, or a damaged one.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let file = path.join(PLAN);
        let text = disk::read(&file, disk::MOST_BYTES).map_err(|cause| match cause.kind() {
            io::ErrorKind::NotFound => {
                let folder = path.display();
                ErrorKind::Missing.error(format!("{folder} contains no study: it has no {PLAN}"))
            }
            _ => error::io(&file)(cause),
        })?;
        parse(path, &text).map_err(error::damaged(&file))
    }

    /// Creates the folder, unless it exists.
    ///
    /// # Errors
    /// When the folder contains something else, or an error of the file system.
    pub fn make(&self) -> Result<(), Error> {
        require_own(&self.path)?;
        let journals = self.journal_folder()?;
        fs::create_dir_all(&journals).map_err(disk::cannot_create(&journals))?;
        if !Self::is_in(&self.path) {
            self.write(false)?;
        }
        // Another process may have made another plan in the meantime.
        Self::in_folder(&self.path, self.protocol.clone(), Some(self.tasks)).map(drop)
    }

    /// Returns the same study in another folder.
    pub(in crate::study) fn moved_to(self, path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            ..self
        }
    }

    /// Writes the plan, and keeps an existing one unless `force` replaces it.
    pub(in crate::study) fn write(&self, force: bool) -> Result<(), Error> {
        let text = self.protocol.to_json();
        let file = PlanFile {
            plan: self.plan.clone(),
            tasks: self.tasks,
            checksum: checksum(&self.plan, self.tasks, &self.earlier),
            earlier: self.earlier.clone(),
            replaced: self.replaced.clone(),
            study: RawValue::from_string(text).expect("JSON is valid JSON"),
        };
        let path = self.path.join(PLAN);
        match disk::write(&path, disk::json(&file).as_bytes(), force) {
            // Another process wrote a plan first. It may also have locked the folder, and removed
            // the temporary file of this process.
            Err(_) if !force && Self::is_in(&self.path) => Ok(()),
            written => written.map_err(error::io(&path)),
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

    /// Returns the trials of a task, counted from 1.
    pub(in crate::study) fn trials_of(&self, task: usize) -> impl Iterator<Item = usize> {
        (task - 1..self.protocol.len()).step_by(self.tasks)
    }

    /// Starts a new journal for trials of a task.
    pub(in crate::study) fn begin(&self, task: usize) -> Result<Journal, Error> {
        let smaller = self.earlier.last().map(|earlier| &earlier.plan[..]);
        Journal::begin(&self.path.join(JOURNALS), task, &self.plan, smaller)
    }

    /// Returns the folder of the journals. A link is refused, because journals are written and removed there.
    fn journal_folder(&self) -> Result<PathBuf, Error> {
        let folder = self.path.join(JOURNALS);
        match folder.is_symlink() {
            true => {
                let message = format!(
                    "{} is a link: replace it with the folder that it points to",
                    folder.display()
                );
                Err(ErrorKind::CannotCreate.error(message))
            }
            false => Ok(folder),
        }
    }

    /// Returns the journals with their tasks, sorted.
    pub(in crate::study) fn journals(&self) -> Result<Vec<(usize, PathBuf)>, Error> {
        let folder = self.journal_folder()?;
        let io = &error::io(&folder);
        let mut found = Vec::new();
        for entry in folder.read_dir().map_err(io)? {
            let name = entry.map_err(io)?.file_name();
            // Ignore other files, such as those of a network file system.
            match name.to_str().and_then(journal::task_of) {
                Some(task) if (1..=self.tasks).contains(&task) => {
                    found.push((task, folder.join(name)));
                }
                _ => {}
            }
        }
        found.sort();
        Ok(found)
    }
}

fn parse(path: &Path, text: &[u8]) -> Result<PlannedStudy, String> {
    let file: PlanFile = serde_json::from_slice(text).map_err(|fault| fault.to_string())?;
    if id_of(file.study.get()) != file.plan {
        return Err("it was changed after it was frozen".to_owned());
    }
    if file.checksum != checksum(&file.plan, file.tasks, &file.earlier) {
        return Err(
            "the number of tasks or an earlier plan was changed after it was frozen".to_owned(),
        );
    }
    let protocol = serde_json::from_str::<Protocol>(file.study.get());
    let protocol = protocol.map_err(|fault| fault.to_string())?;
    protocol.check()?;
    within("tasks", file.tasks, 1..=protocol.len()).map_err(|fault| fault.to_string())?;
    let mut earlier = file.earlier.iter();
    earlier.try_for_each(|earlier| earlier.check(&protocol))?;
    Ok(PlannedStudy {
        path: path.to_owned(),
        protocol,
        plan: file.plan,
        tasks: file.tasks,
        earlier: file.earlier,
        replaced: file.replaced,
    })
}

/// A folder without a plan may contain files that are created before the plan, and nothing else.
fn require_own(path: &Path) -> Result<(), Error> {
    let is_early = |name: &OsString| name == JOURNALS || disk::is_leftover_of(name, PLAN);
    // List the names first: another process may be creating the same plan, and more files after it.
    match names(path)?.iter().all(is_early) || PlannedStudy::is_in(path) {
        true => Ok(()),
        false => Err(ErrorKind::CannotCreate.error(format!(
            "{} contains files that xcscr did not create; refusing to change it: choose another \
             folder with `--out`",
            path.display()
        ))),
    }
}

/// Returns the names of the files in a folder. Empty if the folder does not exist.
fn names(folder: &Path) -> Result<Vec<OsString>, Error> {
    let names = folder.read_dir().and_then(|entries| {
        let names = entries.map(|entry| Ok(entry?.file_name()));
        names.collect::<io::Result<Vec<_>>>()
    });
    match names {
        Err(cause) if cause.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        names => names.map_err(disk::cannot_create(folder)),
    }
}
