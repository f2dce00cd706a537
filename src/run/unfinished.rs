//! `unfinished.json`: what a run needs to begin again, kept until the run is finished.

use std::io;

use serde::{Deserialize, Serialize};

use super::contents::RULES;
use super::folder::RunFolder;
use crate::disk;
use crate::record::RecordMode;
use crate::record::resume_hint::UNFINISHED;
use crate::trial::{Config, Plan};
use crate::world::Maze;
use crate::{Error, ErrorKind};

/// The fields of the file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Unfinished {
    record: RecordMode,
    world: String,
    config: Config,
}

impl RunFolder {
    /// Saves the plan and the recording mode of a run that begins.
    ///
    /// # Errors
    /// An error of the file system.
    pub(super) fn save_unfinished(&self, plan: &Plan, record: RecordMode) -> Result<(), Error> {
        let unfinished = Unfinished {
            record,
            world: plan.maze.to_json(),
            config: plan.config.clone(),
        };
        self.write(UNFINISHED, disk::json(&unfinished).as_bytes())
    }

    /// Returns the plan and the recording mode of the unfinished run; `None` if it is finished.
    ///
    /// # Errors
    /// If there is no run, or its file cannot be read, is damaged, or is of another version.
    pub(super) fn unfinished(&self) -> Result<Option<(Plan, RecordMode)>, Error> {
        let path = self.path().join(UNFINISHED);
        if !path.is_file() && self.path().join(RULES).is_file() {
            return Ok(None);
        }
        let text = disk::read(&path, disk::MOST_BYTES).map_err(|cause| match cause.kind() {
            io::ErrorKind::NotFound => self.nothing_to_resume(),
            _ => disk::cannot_read(&path)(cause),
        })?;
        let useless = |fault: String| {
            let message = format!("cannot resume from {}: {fault}", path.display());
            ErrorKind::BadData.error(message + "; begin a new run with `--force`")
        };
        let Unfinished {
            record,
            world,
            config,
        } = serde_json::from_slice(&text).map_err(|fault| useless(fault.to_string()))?;
        let maze = Maze::from_json(world.as_bytes(), "world.json");
        let maze = maze.map_err(|fault| useless(fault.to_string()))?;
        let (found, own) = (&config.version, env!("CARGO_PKG_VERSION"));
        if found != own {
            return Err(useless(format!(
                "the run was begun by version {found}, and this is version {own}"
            )));
        }
        let plan = Plan { maze, config };
        plan.check().map_err(|fault| useless(fault.to_string()))?;
        Ok(Some((plan, record)))
    }

    /// Removes the file, which marks the run as finished.
    ///
    /// # Errors
    /// An error of the file system.
    pub(super) fn remove_unfinished(&self) -> Result<(), Error> {
        self.remove(UNFINISHED)
    }

    /// Returns the error that the folder contains no unfinished run.
    pub(super) fn nothing_to_resume(&self) -> Error {
        let typed = disk::typed(self.path());
        let message = format!(
            "{} contains no interrupted run: begin one with `xcscr train WORLD --out {typed}`; `--force` \
             replaces an existing run",
            self.path().display()
        );
        ErrorKind::Missing.error(message)
    }
}
