//! Builds the highlights of a run from its recordings alone.

use std::path::{Path, PathBuf};

use tempfile::TempDir;

use super::error::RunError;
use super::evaluation::record_drives;
use super::facts::run_info;
use super::folder::RunFolder;
use super::source::{Source, mode_for_highlights, recorded_mode};
use crate::agent::Knowledge;
use crate::record::reader::Recording;
use crate::record::{
    HighlightsBuilder, RecordMode, Recorder, RecordingKind, Segment, Topic, segments,
};
use crate::trial::{Plan, Trial};

impl RunFolder {
    /// Builds the highlights of the run: `highlights.mcap` as bytes. The same run gives the same bytes.
    ///
    /// Where the folder lacks the recordings of some episodes, the trial is run again.
    ///
    /// # Errors
    /// When the folder is not that of a finished run, or a recording in it is damaged.
    pub fn highlights(&self) -> Result<Vec<u8>, RunError> {
        Material::of(self)?.build()
    }
}

/// Builds the highlights of a trial, which is run for that.
///
/// # Errors
/// When the plan is refused, or a temporary file cannot be written.
pub fn highlights(plan: &Plan, mode: RecordMode) -> Result<Vec<u8>, RunError> {
    Material::again(plan, mode)?.build()
}

impl Source {
    /// Builds the highlights of the recorded trial, which is run again for that.
    ///
    /// # Errors
    /// When the plan is refused, or a temporary file cannot be written.
    pub fn highlights(&self) -> Result<Vec<u8>, RunError> {
        self.require_training()?;
        highlights(&self.plan, self.mode)
    }
}

/// Builds the highlights of the recordings in `folder`, all of which are there.
pub(super) fn build(
    folder: &Path,
    plan: &Plan,
    knowledge: &Knowledge,
) -> Result<Vec<u8>, RunError> {
    Material::in_folder(folder, plan, knowledge)?.build()
}

/// Refuses vast worlds: highlights draw every cell.
fn require_few_cells(plan: &Plan) -> Result<(), RunError> {
    match plan.maze.is_vast() {
        true => Err(RunError::NoHighlights {
            world: plan.maze.name().to_owned(),
        }),
        false => Ok(()),
    }
}

/// What a highlights recording is made of.
pub(super) struct Material {
    plan: Plan,
    /// With beams, or without.
    mode: RecordMode,
    folder: PathBuf,
    segments: Vec<Segment>,
    drive: Recording,
    /// What goes away with this: the folder of a trial that was run again.
    _aside: Option<TempDir>,
}

impl Material {
    /// That of a finished run.
    pub fn of(folder: &RunFolder) -> Result<Self, RunError> {
        let plan = folder.plan()?;
        require_few_cells(&plan)?;
        let knowledge = folder.knowledge()?;
        match has_every_episode(folder.path(), plan.config.episodes) {
            true => Self::in_folder(folder.path(), &plan, &knowledge),
            false => Self::again(&plan, RecordMode::All),
        }
    }

    /// That of a trial, which is run for that, and shows beams if it did so before.
    pub fn again(plan: &Plan, mode: RecordMode) -> Result<Self, RunError> {
        require_few_cells(plan)?;
        let folder = tempfile::tempdir().map_err(RunError::Temporary)?;
        let mut trial = Trial::new(plan.clone())?;
        let (maze, info) = (&trial.plan().maze, run_info(trial.plan()));
        let mut recorder = Recorder::create(folder.path(), maze, info, mode_for_highlights(mode))?;
        // A break comes from the recorder, whose error `finish` gives out.
        let _ = trial.run(&mut recorder);
        recorder.finish(trial.method())?;
        let knowledge = trial.method().knowledge();
        let material = Self::in_folder(folder.path(), trial.plan(), &knowledge)?;
        Ok(Self {
            _aside: Some(folder),
            ..material
        })
    }

    fn in_folder(folder: &Path, plan: &Plan, knowledge: &Knowledge) -> Result<Self, RunError> {
        let plan = plan.clone().settled();
        let run = Recording::open(&folder.join(RecordingKind::Run.file_name()))?;
        let aside = tempfile::tempdir().map_err(RunError::Temporary)?;
        // The drive always shows its beams: they take little, and show what the robot senses.
        let mode = (RecordMode::Beams, &(|| false) as &dyn Fn() -> bool);
        record_drives(&plan, knowledge, 1, aside.path(), mode)?;
        let drive = Recording::open(&aside.path().join(RecordingKind::Episode(1).file_name()))?;
        Ok(Self {
            plan,
            mode: mode_for_highlights(recorded_mode(&run, "run")?),
            folder: folder.to_owned(),
            segments: segments(&run)?,
            drive,
            _aside: None,
        })
    }

    /// Who tells it.
    pub fn builder(&self) -> Result<HighlightsBuilder<'_>, RunError> {
        let (info, senses) = (run_info(&self.plan), self.plan.config.senses());
        let curve = self.whole_curve()?;
        let maze = &self.plan.maze;
        Ok(HighlightsBuilder::new(
            maze, info, self.mode, curve, senses,
        )?)
    }

    /// How many segments there are before the drive.
    pub fn segments(&self) -> usize {
        self.segments.len()
    }

    /// Tells segment `number`, from 0; nothing beyond the last one.
    pub fn tell_chapter(
        &self,
        number: usize,
        builder: &mut HighlightsBuilder<'_>,
    ) -> Result<(), RunError> {
        match self.segments.get(number) {
            Some(segment) => Ok(builder.segment(segment, &self.episode(segment.episode)?)?),
            None => Ok(()),
        }
    }

    /// Tells what was learned.
    pub fn add_drive(&self, builder: &mut HighlightsBuilder<'_>) -> Result<(), RunError> {
        Ok(builder.drive(self.plan.config.episodes, &self.drive)?)
    }

    /// The learning curve of all episodes, as `/curve` has it.
    fn whole_curve(&self) -> Result<Vec<u8>, RunError> {
        let mut last = Vec::new();
        for message in self.episode(self.plan.config.episodes)?.messages() {
            let message = message?;
            if message.topic() == Topic::Curve.name() {
                last = message.data.to_vec();
            }
        }
        Ok(last)
    }

    fn episode(&self, number: u32) -> Result<Recording, RunError> {
        let file = RecordingKind::Episode(number).file_name();
        Ok(Recording::open(&self.folder.join(file))?)
    }

    fn build(&self) -> Result<Vec<u8>, RunError> {
        let mut builder = self.builder()?;
        for number in 0..self.segments() {
            self.tell_chapter(number, &mut builder)?;
        }
        self.add_drive(&mut builder)?;
        Ok(builder.finish()?)
    }
}

fn has_every_episode(folder: &Path, episodes: u32) -> bool {
    let mut extents = (1..=episodes)
        .map(RecordingKind::Episode)
        .chain([RecordingKind::Run]);
    extents.all(|extent| folder.join(extent.file_name()).is_file())
}
