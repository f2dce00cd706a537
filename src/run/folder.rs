//! The folder of a run.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;

use super::contents::{CONFIG, Contents, PAGE, RULES, WORLD, WORTH, file_names, is_of_a_run};
use super::error;
use crate::agent::Knowledge;
use crate::disk::{self, FolderLock, LOCK};
use crate::record::resume_hint::{UNFINISHED, is_resumable, resume_hint, way_to_resume};
use crate::record::world_for_run;
use crate::trial::{Config, Plan};
use crate::world::Maze;
use crate::{Error, ErrorKind};

/// A folder with the files of one run: `world.json`, `config.json`, `rules.json`, recordings, and
/// `unfinished.json` while the run lasts.
#[derive(Debug)]
pub struct RunFolder {
    path: PathBuf,
    /// The lock of a folder opened for writing.
    _lock: Option<FolderLock>,
}

impl RunFolder {
    /// Creates and locks the folder of a new run. An existing run is replaced only if `force` is
    /// set; then its files are removed, and nothing else.
    ///
    /// # Errors
    /// If the folder is not empty, is in use, or cannot be created.
    pub fn create(path: &Path, force: bool) -> Result<Self, Error> {
        // Checked without a lock, so that no lock file is left in a foreign folder. An existing
        // lock may belong to another process that is about to begin there.
        let lock = path.join(LOCK);
        let is_free = !lock.exists() || disk::is_foreign_lock(&lock);
        let contents = || Contents::checked(path).map_err(disk::cannot_create(path));
        if is_free && contents()? == Contents::Foreign {
            return Err(error::foreign(path));
        }
        fs::create_dir_all(path).map_err(disk::cannot_create(path))?;
        let folder = Self::locked(path)?;
        match contents()? {
            Contents::Foreign => Err(error::foreign(path)),
            Contents::Interrupted if !force => {
                let typed = disk::typed(path);
                let message = format!(
                    "{} contains an interrupted run: resume it with `xcscr train --resume {typed}`, \
                     or replace it with `--force`",
                    path.display()
                );
                Err(ErrorKind::CannotCreate.error(message))
            }
            Contents::Run if !force => Err(error::exists(path)),
            Contents::Run | Contents::Interrupted => folder.clear().map(|()| folder),
            Contents::Nothing => folder.tidied(),
        }
    }

    /// Locks the folder of a run to resume it, or to find that the run is finished.
    ///
    /// # Errors
    /// If there is no run, or another process uses the folder.
    pub fn resume(path: &Path) -> Result<Self, Error> {
        match Contents::of(path).map_err(disk::cannot_read(path))? {
            Contents::Interrupted | Contents::Run => Self::locked(path)?.tidied(),
            _ => Err(Self::open(path).nothing_to_resume()),
        }
    }

    fn locked(path: &Path) -> Result<Self, Error> {
        let lock = FolderLock::acquire(path, disk::cannot_create(&path.join(LOCK)))?;
        Ok(Self {
            path: path.to_owned(),
            _lock: Some(lock),
        })
    }

    /// Removes the temporary files that a killed process left.
    fn tidied(self) -> Result<Self, Error> {
        let tidied = disk::remove_leftovers(&self.path, is_of_a_run);
        tidied.map_err(disk::cannot_read(&self.path))?;
        Ok(self)
    }

    /// Returns the names of the files in the folder in order, without names that are not valid
    /// text.
    pub(super) fn names(&self) -> Result<Vec<String>, Error> {
        let names = file_names(&self.path).map_err(disk::cannot_read(&self.path))?;
        let names = names.into_iter();
        let mut names: Vec<String> = names.filter_map(|name| name.into_string().ok()).collect();
        names.sort_unstable();
        Ok(names)
    }

    /// Removes the files of the run; those that identify the folder as a run come last.
    fn clear(&self) -> Result<(), Error> {
        let mut names = self.names()?;
        names.retain(|name| is_of_a_run(name) && name != CONFIG && name != UNFINISHED);
        names.extend([UNFINISHED.to_owned(), CONFIG.to_owned()]);
        names.iter().try_for_each(|name| self.remove(name))
    }

    pub(super) fn remove(&self, name: &str) -> Result<(), Error> {
        let path = self.path.join(name);
        disk::remove(&path).map_err(disk::cannot_write(&path))
    }

    /// Opens the folder of an existing run for reading.
    pub fn open(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            _lock: None,
        }
    }

    /// Returns how to resume the run, for the end of a message; empty if it is finished.
    pub fn resume_hint(&self) -> String {
        way_to_resume(&self.path).map_or_else(String::new, |hint| format!("; {hint}"))
    }

    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Saves the plan of the run.
    ///
    /// # Errors
    /// An error of the file system.
    pub fn save_plan(&self, plan: &Plan) -> Result<(), Error> {
        let mut texts = Self::texts_of(plan).into_iter();
        texts.try_for_each(|(name, text)| self.write(name, text.as_bytes()))
    }

    /// Returns the names and texts of the files of a plan.
    pub(super) fn texts_of(plan: &Plan) -> [(&'static str, String); 2] {
        [
            (WORLD, plan.maze.to_json()),
            (CONFIG, disk::json(&plan.config)),
        ]
    }

    /// Returns the plan of the run.
    ///
    /// # Errors
    /// If a file is missing, damaged or unreadable.
    pub fn plan(&self) -> Result<Plan, Error> {
        let maze = Maze::load(&self.existing(WORLD)?)?;
        let config: Config = self.read(CONFIG)?;
        let plan = Plan { maze, config };
        plan.check().map_err(|fault| self.damaged(CONFIG, &fault))?;
        Ok(plan)
    }

    /// Saves the learned knowledge.
    ///
    /// # Errors
    /// An error of the file system.
    pub fn save_knowledge(&self, knowledge: &Knowledge) -> Result<(), Error> {
        self.write(RULES, disk::json(knowledge).as_bytes())
    }

    /// Returns the learned knowledge.
    ///
    /// # Errors
    /// If the file is missing, damaged or unreadable.
    pub fn knowledge(&self) -> Result<Knowledge, Error> {
        self.read(RULES)
    }

    /// Saves the page that plays the run.
    ///
    /// # Errors
    /// An error of the file system.
    pub fn save_page(&self, page: &str) -> Result<(), Error> {
        self.write(PAGE, page.as_bytes())
    }

    /// Saves the picture of the action values.
    ///
    /// # Errors
    /// An error of the file system.
    pub(super) fn save_picture(&self, svg: &str) -> Result<(), Error> {
        self.write(WORTH, svg.as_bytes())
    }

    /// Returns the picture of the action values, if there is one.
    pub fn picture(&self) -> Option<PathBuf> {
        let picture = self.path.join(WORTH);
        picture.is_file().then_some(picture)
    }

    /// Returns the page that plays the run, if there is one.
    pub fn page(&self) -> Option<PathBuf> {
        let page = self.path.join(PAGE);
        page.is_file().then_some(page)
    }

    /// Returns true if the run is interrupted.
    pub fn is_interrupted(&self) -> bool {
        matches!(Contents::of(&self.path), Ok(Contents::Interrupted))
    }

    fn existing(&self, name: &str) -> Result<PathBuf, Error> {
        let path = self.path.join(name);
        match path.exists() {
            true => Ok(path),
            false if is_resumable(&self.path) => {
                let (folder, hint) = (self.path.display(), resume_hint(&self.path));
                let message = format!(
                    "{folder} has no {name} yet: the run is not finished; wait until it is, or if it was stopped, {hint}"
                );
                Err(ErrorKind::Missing.error(message))
            }
            false => Err(world_for_run(&self.path).unwrap_or_else(|| {
                let (path, folder) = (path.display(), self.path.display());
                let message =
                    format!("{path} is missing: is {folder} the folder of a finished run?");
                ErrorKind::Missing.error(message)
            })),
        }
    }

    fn read<T: DeserializeOwned>(&self, name: &str) -> Result<T, Error> {
        let path = self.existing(name)?;
        let text = disk::read(&path, disk::MOST_BYTES);
        let text = text.map_err(|cause| match cause.kind() {
            io::ErrorKind::FileTooLarge => self.damaged(name, &cause),
            _ => disk::cannot_read(&path)(cause),
        })?;
        serde_json::from_slice(&text).map_err(|fault| self.damaged(name, &fault))
    }

    fn damaged(&self, name: &str, fault: &dyn std::fmt::Display) -> Error {
        let message = format!("{} is damaged: {fault}", self.path.join(name).display());
        ErrorKind::BadData.error(message)
    }

    pub(super) fn write(&self, name: &str, bytes: &[u8]) -> Result<(), Error> {
        let path = self.path.join(name);
        disk::replace(&path, bytes).map_err(disk::cannot_write(&path))
    }
}
