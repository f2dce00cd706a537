//! Recordings of episodes that are driven from Python.

use std::path::{Path, PathBuf};

use pyo3::prelude::*;
use xcscr::record::RecordMode;
use xcscr::record::reader::Recording as Recorded;
use xcscr::run::{Again, ExternalActions, ExternalEpisode, ExternalRecorder, Source, WheelSpeeds};

use crate::plan::{Choice, invalid};

/// A recording in progress.
#[pyclass(unsendable, module = "xcscr._native")]
pub struct Recording {
    recorder: Option<ExternalRecorder>,
}

#[pymethods]
impl Recording {
    /// Begins a recording in a missing or empty folder. `record` is a recording mode of the program.
    #[new]
    fn new(choice: Choice, folder: PathBuf, record: &str) -> PyResult<Self> {
        let plan = choice.plan(None, 1)?;
        let mode: RecordMode = record.parse().map_err(invalid)?;
        let recorder = ExternalRecorder::create(&folder, &plan, mode).map_err(invalid)?;
        let recorder = Some(recorder);
        Ok(Self { recorder })
    }

    /// Repeats and records an episode: the seed of its noise, its start, its actions and their rewards. Returns the pose
    /// at the end.
    fn episode(
        &mut self,
        seed: u64,
        start: (u16, u16),
        actions: Vec<usize>,
        rewards: Vec<f64>,
    ) -> PyResult<(f64, f64, f64)> {
        self.add(ExternalEpisode {
            seed,
            start,
            actions: ExternalActions::Moves(actions),
            rewards,
        })
    }

    /// Repeats and records an episode of wheel speeds, in m/s for each step of 50 ms, from a heading in radians. Returns
    /// the pose at the end.
    fn drive(
        &mut self,
        seed: u64,
        start: (u16, u16),
        heading: f64,
        speeds: Vec<[f64; 2]>,
        rewards: Vec<f64>,
    ) -> PyResult<(f64, f64, f64)> {
        let wheels = WheelSpeeds {
            heading_rad: heading,
            speeds_mps: speeds,
        };
        self.add(ExternalEpisode {
            seed,
            start,
            actions: ExternalActions::Wheels(wheels),
            rewards,
        })
    }

    /// Finishes the recording. Returns the paths of its files; none if it is closed already.
    fn close(&mut self) -> PyResult<Vec<PathBuf>> {
        match self.recorder.take() {
            Some(recorder) => Ok(recorder.finish().map_err(invalid)?.files),
            None => Ok(Vec::new()),
        }
    }
}

impl Recording {
    /// Records an episode. Returns the pose at the end.
    fn add(&mut self, episode: ExternalEpisode) -> PyResult<(f64, f64, f64)> {
        let closed = || invalid("the recording is closed");
        let recorder = self.recorder.as_mut().ok_or_else(closed)?;
        let end = recorder.record(episode).map_err(invalid)?.robot_in_map;
        let at = end.translation;
        Ok((at.x, at.y, end.rotation.angle()))
    }
}

/// Checks a recording, and compares it with a repeated run. Returns the first fault, or `None`.
#[pyfunction]
pub fn verify_recording(py: Python<'_>, file: PathBuf) -> PyResult<Option<String>> {
    py.detach(|| fault(&file)).map_err(invalid)
}

fn fault(file: &Path) -> Result<Option<String>, xcscr::Error> {
    let recording = Recorded::open(file)?;
    if let Some(fault) = recording.check().into_iter().next() {
        return Ok(Some(fault));
    }
    let source = Source::of(file)?;
    Again::new(&source, &mut ())?.difference(&source)
}
