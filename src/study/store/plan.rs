//! The plan of a study in its folder: the frozen study, and the number of its tasks.

use std::ffi::OsString;
use std::fs;
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use xcs::bounds::within;

use super::journal::JOURNALS;
use crate::disk;
use crate::study::error;
use crate::study::protocol::{Protocol, id_of};
use crate::{Error, ErrorKind};

/// The file of the plan.
pub(super) const PLAN: &str = "study.json";

/// The contents of `study.json`.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PlanFile {
    /// The checksum of the study's text.
    plan: String,
    tasks: usize,
    /// The checksum of the plan, the number of tasks and the ids of the arms.
    checksum: String,
    #[serde(default)]
    arms: Vec<String>,
    study: Box<RawValue>,
}

/// A frozen study that is split into tasks, for any number of processes and machines.
#[derive(Debug, Clone)]
pub(super) struct StoredPlan {
    pub protocol: Protocol,
    /// The id of the protocol, as stored. A newer program may have more settings, and so another id.
    pub id: String,
    /// The id of each arm, as stored.
    pub arms: Vec<String>,
    /// The number of tasks. It is stored here, and nowhere else.
    pub tasks: usize,
}

impl StoredPlan {
    /// Plans a study of this many tasks. Writes nothing.
    pub fn new(protocol: Protocol, tasks: usize) -> Result<Self, Error> {
        protocol.check_tasks(tasks)?;
        Ok(Self {
            id: protocol.id(),
            arms: protocol.arm_ids(),
            protocol,
            tasks,
        })
    }

    /// Returns true if the folder contains a study.
    pub fn is_in(path: &Path) -> bool {
        path.join(PLAN).is_file()
    }

    /// Reads the plan in the folder of a study.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let file = path.join(PLAN);
        let text = disk::read(&file, disk::MOST_BYTES).map_err(|cause| match cause.kind() {
            io::ErrorKind::NotFound => {
                let folder = path.display();
                ErrorKind::Missing.error(format!("{folder} contains no study: it has no {PLAN}"))
            }
            _ => error::io(&file)(cause),
        })?;
        Self::parse(&text).map_err(error::damaged(&file))
    }

    fn parse(text: &[u8]) -> Result<Self, String> {
        let file: PlanFile = serde_json::from_slice(text).map_err(|fault| fault.to_string())?;
        if id_of(file.study.get()) != file.plan {
            return Err("it was changed after it was frozen".to_owned());
        }
        let protocol = serde_json::from_str::<Protocol>(file.study.get());
        let protocol = protocol.map_err(|fault| fault.to_string())?;
        if file.arms.is_empty() {
            let fault =
                "an earlier version of xcscr planned it: run the study again, in another folder";
            return Err(fault.to_owned());
        }
        let checksum = checksum(&file.plan, file.tasks, &file.arms);
        if (file.checksum, file.arms.len()) != (checksum, protocol.arms.len()) {
            return Err("the number of tasks or an arm was changed after it was frozen".to_owned());
        }
        protocol.check()?;
        let tasks = within("tasks", file.tasks, 1..=protocol.len());
        tasks.map_err(|fault| fault.to_string())?;
        Ok(Self {
            protocol,
            id: file.plan,
            arms: file.arms,
            tasks: file.tasks,
        })
    }

    /// Creates the folder with this plan, unless it has a plan. Returns the plan that it has then.
    ///
    /// # Errors
    /// When the folder contains something else, or an error of the file system.
    pub fn create(&self, path: &Path) -> Result<Self, Error> {
        if !Self::is_in(path) {
            require_own(path)?;
            let journals = path.join(JOURNALS);
            fs::create_dir_all(&journals).map_err(disk::cannot_create(&journals))?;
            match self.write(path, false) {
                // Another process wrote a plan first. It may also have locked the folder, and removed
                // the temporary file of this process.
                Err(_) if Self::is_in(path) => {}
                written => written?,
            }
        }
        Self::read(path)
    }

    /// Writes the plan, and replaces another one only with `force`.
    pub fn write(&self, path: &Path, force: bool) -> Result<(), Error> {
        let file = PlanFile {
            plan: self.id.clone(),
            tasks: self.tasks,
            checksum: checksum(&self.id, self.tasks, &self.arms),
            arms: self.arms.clone(),
            study: RawValue::from_string(self.protocol.to_json()).expect("JSON is valid JSON"),
        };
        let path = path.join(PLAN);
        disk::write(&path, disk::json(&file).as_bytes(), force).map_err(error::io(&path))
    }

    /// Returns true if this study has all trials of `found`, and others or another reference method.
    pub fn extends(&self, found: &Self) -> bool {
        let (ours, theirs) = (&self.protocol, &found.protocol);
        ours.name == theirs.name
            && ours.trials >= theirs.trials
            && self.id != found.id
            && found.arms.iter().all(|arm| self.arms.contains(arm))
    }
}

/// Protects the number of tasks and the ids of the arms, which are not part of the study's id.
fn checksum(plan: &str, tasks: usize, arms: &[String]) -> String {
    id_of(&format!("{plan} in {tasks} tasks: {}", arms.join(", ")))
}

/// A folder without a plan may contain files that are created before the plan, and nothing else.
fn require_own(path: &Path) -> Result<(), Error> {
    let is_early = |name: &OsString| name == JOURNALS || disk::is_leftover_of(name, PLAN);
    // List the names first: another process may be creating the same plan, and more files after it.
    if names(path)?.iter().all(is_early) || StoredPlan::is_in(path) {
        Ok(())
    } else {
        Err(ErrorKind::CannotCreate.error(format!(
            "{} contains files that xcscr did not create; refusing to change it: choose another \
             folder with `--out`",
            path.display()
        )))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::protocol::frozen;

    #[test]
    fn a_study_extends_another_that_has_some_of_its_trials_and_differs_in_nothing_else() {
        let small = "name = 's'\nworlds = ['maze4']\nmethods = ['xcs', 'xcscr']\ntrials = 2\nepisodes = 3\n";
        let plan = |text: &str| StoredPlan::new(frozen(text, &[]).unwrap(), 1).unwrap();
        let found = plan(small);
        for (from, to, extends) in [
            ("trials = 2", "trials = 3", true),
            ("'xcs', ", "'xcs', 'r-max', ", true),
            ("'maze4'", "'maze5', 'maze4'", true),
            ("name", "reference = 'xcs'\nname", true),
            ("trials = 2", "trials = 1", false),
            ("'xcs', ", "", false),
            ("episodes = 3", "episodes = 4", false),
            ("episodes = 3", "drives = 1\nepisodes = 3", false),
            ("name = 's'", "name = 't'", false),
            ("name", "seed = 2\nname", false),
            ("", "", false),
        ] {
            let changed = plan(&small.replace(from, to));
            assert_eq!(changed.extends(&found), extends, "{from} to {to}");
        }
        let mut other = found.protocol.clone();
        let text = include_str!("../../../worlds/maze5.json").replace("\"maze5\"", "\"maze4\"");
        other.worlds = vec![crate::world::Maze::from_json(text.as_bytes(), "maze4").unwrap()];
        assert!(!StoredPlan::new(other, 1).unwrap().extends(&found));
    }
}
