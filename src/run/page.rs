//! The page of a run, from its recordings alone.

use std::path::{Path, PathBuf};

use tempfile::TempDir;

use super::error;
use super::evaluation::record_drives;
use super::folder::RunFolder;
use super::repetition::Repetition;
use super::run_inputs::RunInputs;
use crate::agent::Knowledge;
use crate::record::reader::Recording;
use crate::record::{RecordMode, RecordingKind};
use crate::replay::player;
use crate::trial::Plan;
use crate::world::Paths;
use crate::{Error, ErrorKind};

/// The step limit of the drive of the learned policy, in shortest paths from the farthest start.
const SHORTEST_PATHS: u32 = 4;

impl RunFolder {
    /// Returns the page that plays the run. The same run produces the same page.
    ///
    /// If the folder lacks the recordings of some episodes, the trial is run again.
    ///
    /// # Errors
    /// If the folder does not contain a finished run, or one of its recordings is damaged.
    pub fn replay_page(&self) -> Result<String, Error> {
        let plan = self.plan()?;
        let knowledge = self.knowledge()?;
        if has_every_episode(self.path(), plan.config.episodes) {
            page_of(self.path(), &plan, &knowledge)
        } else {
            page(&plan)
        }
    }
}

/// Runs a trial and returns the page that plays it.
///
/// # Errors
/// If the plan is invalid, or a temporary file cannot be written.
pub fn page(plan: &Plan) -> Result<String, Error> {
    require_few_cells(plan)?;
    let again = Repetition::of(RunInputs::training(plan.clone()), RecordMode::All, &mut ())?;
    page_of(again.folder.path(), plan, &again.knowledge)
}

/// Returns the page of the run whose episodes are all recorded in `folder`.
pub(super) fn page_of(folder: &Path, plan: &Plan, knowledge: &Knowledge) -> Result<String, Error> {
    require_few_cells(plan)?;
    let run = Recording::open(&folder.join(RecordingKind::Run.file_name()))?;
    let episodes = (1..=plan.config.episodes).map(RecordingKind::Episode);
    let episodes: Vec<PathBuf> = episodes.map(|kind| folder.join(kind.file_name())).collect();
    let (_folder, drive) = recorded_drive(plan, knowledge)?;
    player::page_of_run(&drive, &run, &episodes)
}

/// Records a drive of the learned policy in a temporary folder.
fn recorded_drive(plan: &Plan, knowledge: &Knowledge) -> Result<(TempDir, Recording), Error> {
    let folder = tempfile::tempdir().map_err(error::temporary)?;
    record_drives(&limited(plan), knowledge, 1, folder.path())?;
    let drive = Recording::open(&folder.path().join(RecordingKind::Episode(1).file_name()))?;
    Ok((folder, drive))
}

/// Limits the steps of a drive to a few shortest paths: a policy that goes in circles would fill the page.
fn limited(plan: &Plan) -> Plan {
    let mut plan = plan.clone();
    let longest = Paths::new(&plan.maze).longest(&plan.maze);
    let reward = &mut plan.config.settings.reward;
    let limit = longest.saturating_mul(SHORTEST_PATHS).max(1);
    reward.step_threshold = reward.step_threshold.min(limit);
    reward.step_threshold_from_maze = false;
    plan
}

/// Rejects very large worlds, because the page draws every cell.
fn require_few_cells(plan: &Plan) -> Result<(), Error> {
    if plan.maze.is_too_large() {
        let message = format!(
            "{} has too many cells for the page of a run, which draws each of them; watch single \
                 episodes instead",
            plan.maze.name()
        );
        Err(ErrorKind::BadData.error(message))
    } else {
        Ok(())
    }
}

fn has_every_episode(folder: &Path, episodes: u32) -> bool {
    let mut kinds = (1..=episodes)
        .map(RecordingKind::Episode)
        .chain([RecordingKind::Run]);
    kinds.all(|kind| folder.join(kind.file_name()).is_file())
}
