//! Builds the highlights of a run from its recordings alone.

use std::path::{Path, PathBuf};

use super::error;
use super::evaluation::record_drives;
use super::facts::run_info;
use super::folder::RunFolder;
use super::rerun::Rerun;
use super::source::{Source, mode_for_highlights, recorded_mode};
use super::verify::Again;
use crate::agent::Knowledge;
use crate::error::{Error, ErrorKind};
use crate::record::player;
use crate::record::reader::Recording;
use crate::record::{
    HighlightsBuilder, RecordMode, RecordingKind, Segment, ShownRun, Topic, segments,
};
use crate::trial::Plan;

impl RunFolder {
    /// Returns the highlights of the run as the bytes of `highlights.mcap`. The same run produces
    /// the same bytes.
    ///
    /// If the folder lacks the recordings of some episodes, the trial is run again.
    ///
    /// # Errors
    /// If the folder does not contain a finished run, or one of its recordings is damaged.
    pub fn highlights(&self) -> Result<Vec<u8>, Error> {
        Material::of(self)?.build()
    }
}

/// Runs a trial and returns the page that plays its highlights and its episodes.
///
/// # Errors
/// If the plan is invalid, or a temporary file cannot be written.
pub fn page(plan: &Plan, mode: RecordMode) -> Result<String, Error> {
    let material = Material::again(plan, mode)?;
    material.page(material.build()?)
}

impl Source {
    /// Repeats the recorded trial and returns its highlights.
    ///
    /// # Errors
    /// If the plan is invalid, the recording shows an evaluation, or a temporary file cannot be
    /// written.
    pub fn highlights(&self) -> Result<Vec<u8>, Error> {
        self.require_training()?;
        Material::again(&self.run.plan, self.mode)?.build()
    }
}

/// Rejects very large worlds, because highlights draw every cell.
fn require_few_cells(plan: &Plan) -> Result<(), Error> {
    match plan.maze.is_too_large() {
        true => {
            let message = format!(
                "{} has too many cells for a highlights recording, which draws each of them; watch single \
                 episodes instead",
                plan.maze.name()
            );
            Err(ErrorKind::BadData.error(message))
        }
        false => Ok(()),
    }
}

/// The sources of a highlights recording.
pub(super) struct Material {
    plan: Plan,
    /// [`RecordMode::Beams`] if the run recorded beams; otherwise [`RecordMode::All`].
    mode: RecordMode,
    folder: PathBuf,
    segments: Vec<Segment>,
    drive: Recording,
    /// The repeated trial, whose temporary folder is deleted with this value.
    _again: Option<Again>,
}

impl Material {
    /// Collects the sources from a finished run.
    pub fn of(folder: &RunFolder) -> Result<Self, Error> {
        let plan = folder.plan()?;
        require_few_cells(&plan)?;
        let knowledge = folder.knowledge()?;
        match has_every_episode(folder.path(), plan.config.episodes) {
            true => Self::in_folder(folder.path(), &plan, &knowledge),
            false => Self::again(&plan, RecordMode::All),
        }
    }

    /// Runs the trial again, with beams if they were recorded before.
    pub fn again(plan: &Plan, mode: RecordMode) -> Result<Self, Error> {
        require_few_cells(plan)?;
        let run = Rerun::training(plan.clone());
        let again = Again::of(run, mode_for_highlights(mode), &mut ())?;
        let material = Self::in_folder(again.folder.path(), plan, &again.knowledge)?;
        Ok(Self {
            _again: Some(again),
            ..material
        })
    }

    /// Collects the sources from the complete recordings in `folder`.
    pub fn in_folder(folder: &Path, plan: &Plan, knowledge: &Knowledge) -> Result<Self, Error> {
        let plan = plan.clone().settled();
        let run = Recording::open(&folder.join(RecordingKind::Run.file_name()))?;
        let temporary = tempfile::tempdir().map_err(error::temporary)?;
        // The drive always includes beams: they take little space, and show the sensor readings.
        let mode = (RecordMode::Beams, &(|| false) as &dyn Fn() -> bool);
        record_drives(&plan, knowledge, 1, temporary.path(), mode)?;
        let drive = Recording::open(&temporary.path().join(RecordingKind::Episode(1).file_name()))?;
        Ok(Self {
            plan,
            mode: mode_for_highlights(recorded_mode(&run, "run")?),
            folder: folder.to_owned(),
            segments: segments(&run)?,
            drive,
            _again: None,
        })
    }

    /// Creates the builder of the highlights.
    pub fn builder(&self) -> Result<HighlightsBuilder<'_>, Error> {
        let run = ShownRun {
            maze: &self.plan.maze,
            info: run_info(&self.plan),
            mode: self.mode,
            senses: self.plan.config.senses(),
        };
        HighlightsBuilder::new(run, self.whole_curve()?)
    }

    /// Returns the number of segments before the drive.
    pub fn segments(&self) -> usize {
        self.segments.len()
    }

    /// Adds segment `number`, from 0; nothing beyond the last one.
    pub fn add_segment(
        &self,
        number: usize,
        builder: &mut HighlightsBuilder<'_>,
    ) -> Result<(), Error> {
        match self.segments.get(number) {
            Some(segment) => Ok(builder.segment(segment, &self.episode(segment.episode)?)?),
            None => Ok(()),
        }
    }

    /// Adds the drive of the learned policy.
    pub fn add_drive(&self, builder: &mut HighlightsBuilder<'_>) -> Result<(), Error> {
        builder.drive(self.plan.config.episodes, &self.drive)
    }

    /// Returns the learning curve of all episodes, as a message of `/curve`.
    fn whole_curve(&self) -> Result<Vec<u8>, Error> {
        let mut last = Vec::new();
        for message in self.episode(self.plan.config.episodes)?.messages() {
            let message = message?;
            if message.topic() == Topic::Curve.name() {
                last = message.data.to_vec();
            }
        }
        Ok(last)
    }

    fn episode(&self, number: u32) -> Result<Recording, Error> {
        let file = RecordingKind::Episode(number).file_name();
        Recording::open(&self.folder.join(file))
    }

    /// Returns the highlights as the bytes of a file.
    pub fn build(&self) -> Result<Vec<u8>, Error> {
        let mut builder = self.builder()?;
        for number in 0..self.segments() {
            self.add_segment(number, &mut builder)?;
        }
        self.add_drive(&mut builder)?;
        builder.finish()
    }
}

impl Material {
    /// Returns the page that plays these highlights and the episodes.
    pub fn page(&self, highlights: Vec<u8>) -> Result<String, Error> {
        let name = RecordingKind::Highlights.file_name();
        let episodes = (1..=self.plan.config.episodes).map(RecordingKind::Episode);
        let episodes = episodes.map(|kind| self.folder.join(kind.file_name()));
        let episodes: Vec<PathBuf> = episodes.collect();
        let highlights = Recording::from_bytes(&self.folder.join(name), highlights)?;
        player::page_of_run(&highlights, &episodes)
    }
}

fn has_every_episode(folder: &Path, episodes: u32) -> bool {
    let mut kinds = (1..=episodes)
        .map(RecordingKind::Episode)
        .chain([RecordingKind::Run]);
    kinds.all(|kind| folder.join(kind.file_name()).is_file())
}
