//! The story of a run, made of its recordings alone.

use std::path::Path;

use super::error::RunError;
use super::evaluation::record_evaluation;
use super::facts::run_info;
use super::folder::RunFolder;
use crate::agent::Knowledge;
use crate::record::reader::Recording;
use crate::record::{Extent, RecordMode, Recorder, Teller, chapters};
use crate::trial::{Plan, Trial};

/// Tells the story of a run: `story.mcap` as bytes. The same run gives the same bytes.
///
/// Where the folder lacks the recordings of some episodes, the trial is run again.
///
/// # Errors
/// When the folder is not that of a finished run, or a recording in it is damaged.
pub fn story_of(folder: &RunFolder) -> Result<Vec<u8>, RunError> {
    let plan = folder.plan()?;
    let knowledge = folder.knowledge()?;
    match has_every_episode(folder.path(), plan.config.episodes) {
        true => tell(folder.path(), &plan, &knowledge),
        false => story_again(&plan),
    }
}

/// Tells the story of a trial, which is run for that.
///
/// # Errors
/// When the plan is refused, or a temporary file cannot be written.
pub fn story_again(plan: &Plan) -> Result<Vec<u8>, RunError> {
    let folder = tempfile::tempdir().map_err(RunError::Temporary)?;
    let mut trial = Trial::new(plan.clone())?;
    let (maze, info) = (&trial.plan().maze, run_info(trial.plan()));
    let mut recorder = Recorder::create(folder.path(), maze, info, RecordMode::All)?;
    // A break comes from the recorder, whose error `finish` gives out.
    let _ = trial.run(&mut recorder);
    recorder.finish(trial.method())?;
    tell(folder.path(), trial.plan(), &trial.method().knowledge())
}

fn has_every_episode(folder: &Path, episodes: u32) -> bool {
    let mut extents = (1..=episodes).map(Extent::Episode).chain([Extent::Run]);
    extents.all(|extent| folder.join(extent.file_name()).is_file())
}

/// Tells the story of the recordings in `folder`, all of which are there.
pub(super) fn tell(folder: &Path, plan: &Plan, knowledge: &Knowledge) -> Result<Vec<u8>, RunError> {
    let open = |extent: Extent| Recording::open(&folder.join(extent.file_name()));
    let plan = &plan.clone().settled();
    let senses = plan.config.senses();
    let mut teller = Teller::new(&plan.maze, &run_info(plan), senses)?;
    for chapter in chapters(&open(Extent::Run)?)? {
        teller.chapter(&chapter, &open(Extent::Episode(chapter.episode))?)?;
    }
    let aside = tempfile::tempdir().map_err(RunError::Temporary)?;
    record_evaluation(plan, knowledge, 1, aside.path())?;
    let drive = aside.path().join(Extent::Episode(1).file_name());
    teller.drive(plan.config.episodes, &Recording::open(&drive)?)?;
    Ok(teller.finish()?)
}
