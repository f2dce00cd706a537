//! The folder that a run leaves behind.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::plan::{Config, Plan};
use crate::reward::Knowledge;
use crate::world::{Maze, WorldError};

/// The world, as the run used it.
const WORLD: &str = "world.json";
/// All that was chosen.
const CONFIG: &str = "config.json";
/// What was learned.
const RULES: &str = "rules.json";

/// Why a run folder cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum RunFolderError {
    /// There is a run already.
    #[error("{0} exists: choose another folder with `--out`, or replace it with `--force`")]
    Exists(PathBuf),
    /// A file of the run is missing.
    #[error("{0} is missing: is {parent} the folder of a finished run?", parent = .0.parent().unwrap_or(.0).display())]
    Missing(PathBuf),
    /// A file of the run holds something else.
    #[error("{path} is damaged: {fault}")]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        fault: String,
    },
    /// The world of the run is no good.
    #[error(transparent)]
    World(#[from] WorldError),
    /// A file cannot be made.
    #[error("cannot create {path}: {cause}")]
    Create {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        cause: io::Error,
    },
    /// A file cannot be read or written.
    #[error("{path}: {cause}")]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: io::Error,
    },
}

/// A folder with the files of one run: `world.json`, `config.json`, `rules.json`, recordings.
#[derive(Debug, Clone)]
pub struct RunFolder {
    path: PathBuf,
}

impl RunFolder {
    /// Makes the folder of a new run. One that exists is replaced only if `force` is set, and only
    /// if it is empty or holds a run.
    ///
    /// # Errors
    /// [`RunFolderError::Exists`], or an error of the file system.
    pub fn create(path: &Path, force: bool) -> Result<Self, RunFolderError> {
        let is_empty = |path: &Path| path.read_dir().is_ok_and(|mut dir| dir.next().is_none());
        if path.exists() && !is_empty(path) {
            if !force || !path.join(CONFIG).is_file() {
                return Err(RunFolderError::Exists(path.to_owned()));
            }
            let create = |cause| RunFolderError::Create {
                path: path.to_owned(),
                cause,
            };
            fs::remove_dir_all(path).map_err(create)?;
        }
        let create = |cause| RunFolderError::Create {
            path: path.to_owned(),
            cause,
        };
        fs::create_dir_all(path).map_err(create)?;
        Ok(Self {
            path: path.to_owned(),
        })
    }

    /// The folder of a run that exists.
    pub fn open(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
        }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Saves what the run is about to do.
    ///
    /// # Errors
    /// An error of the file system.
    pub fn save_plan(&self, plan: &Plan) -> Result<(), RunFolderError> {
        self.write(WORLD, &plan.maze.to_json())?;
        self.write(CONFIG, &to_json(&plan.config))
    }

    /// The plan of the run.
    ///
    /// # Errors
    /// When a file is missing, damaged or unreadable.
    pub fn plan(&self) -> Result<Plan, RunFolderError> {
        let maze = Maze::load(&self.existing(WORLD)?)?;
        let config: Config = self.read(CONFIG)?;
        let plan = Plan { maze, config };
        plan.check().map_err(|fault| self.damaged(CONFIG, &fault))?;
        Ok(plan)
    }

    /// Saves what was learned.
    ///
    /// # Errors
    /// An error of the file system.
    pub fn save_knowledge(&self, knowledge: &Knowledge) -> Result<(), RunFolderError> {
        self.write(RULES, &to_json(knowledge))
    }

    /// What was learned.
    ///
    /// # Errors
    /// When the file is missing, damaged or unreadable.
    pub fn knowledge(&self) -> Result<Knowledge, RunFolderError> {
        self.read(RULES)
    }

    fn existing(&self, name: &str) -> Result<PathBuf, RunFolderError> {
        let path = self.path.join(name);
        if path.is_file() {
            Ok(path)
        } else {
            Err(RunFolderError::Missing(path))
        }
    }

    fn read<T: serde::de::DeserializeOwned>(&self, name: &str) -> Result<T, RunFolderError> {
        let path = self.existing(name)?;
        let text = fs::read(&path).map_err(|cause| RunFolderError::Io { path, cause })?;
        serde_json::from_slice(&text).map_err(|fault| self.damaged(name, &fault))
    }

    fn damaged(&self, name: &str, fault: &dyn std::fmt::Display) -> RunFolderError {
        RunFolderError::Damaged {
            path: self.path.join(name),
            fault: fault.to_string(),
        }
    }

    /// Writes a file so that it is there either whole or not at all.
    fn write(&self, name: &str, text: &str) -> Result<(), RunFolderError> {
        let path = self.path.join(name);
        let part = self.path.join(format!("{name}.part"));
        let written = File::create(&part).and_then(|mut file| {
            file.write_all(text.as_bytes())?;
            file.sync_all()?;
            fs::rename(&part, &path)
        });
        written.map_err(|cause| RunFolderError::Io { path, cause })
    }
}

fn to_json(value: &impl serde::Serialize) -> String {
    let mut text = serde_json::to_string_pretty(value).expect("plain data becomes JSON");
    text.push('\n');
    text
}
