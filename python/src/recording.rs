//! Recordings of episodes that are driven from Python.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;
use xcscr::record::RecordMode;
use xcscr::record::reader::Recording as Recorded;
use xcscr::run::{
    ExternalActions, ExternalEpisode, ExternalRecorder, RecordedRun, Repetition, WheelSpeeds,
};

use crate::plan::{Choice, invalid};
use crate::process::Owner;

/// A recording in progress.
#[pyclass(frozen, module = "xcscr._native")]
pub struct Recording {
    owner: Owner,
    recorder: Mutex<Option<ExternalRecorder>>,
}

#[pymethods]
impl Recording {
    /// Begins a recording in a missing or empty folder. `record` is a recording mode of the program.
    #[new]
    fn new(py: Python<'_>, choice: Choice, folder: PathBuf, record: &str) -> PyResult<Self> {
        let mode: RecordMode = record.parse().map_err(invalid)?;
        let recorder = py.detach(|| {
            let plan = choice.plan(None, 1)?;
            ExternalRecorder::create(&folder, &plan, mode).map_err(invalid)
        })?;
        Ok(Self {
            owner: Owner::this(),
            recorder: Mutex::new(Some(recorder)),
        })
    }

    /// Repeats and records an episode: the seed of its noise, its start, its actions and their rewards. Returns the pose
    /// at the end.
    fn episode(
        &self,
        py: Python<'_>,
        seed: u64,
        start: (u16, u16),
        actions: Vec<usize>,
        rewards: Vec<f64>,
    ) -> PyResult<(f64, f64, f64)> {
        let actions = ExternalActions::Moves(actions);
        let episode = ExternalEpisode {
            seed,
            start,
            actions,
            rewards,
        };
        self.add(py, episode)
    }

    /// Repeats and records an episode of wheel speeds, in m/s for each step of 50 ms, from a heading in radians. Returns
    /// the pose at the end.
    fn drive(
        &self,
        py: Python<'_>,
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
        let actions = ExternalActions::Wheels(wheels);
        let episode = ExternalEpisode {
            seed,
            start,
            actions,
            rewards,
        };
        self.add(py, episode)
    }

    /// Finishes the recording. Returns the paths of its files; none if it is closed already.
    fn close(&self, py: Python<'_>) -> PyResult<Vec<PathBuf>> {
        self.with(py, |recorder| match recorder.take() {
            Some(recorder) => Ok(recorder.finish().map_err(invalid)?.files),
            None => Ok(Vec::new()),
        })
    }
}

impl Recording {
    /// Calls `act` with the recorder, without holding Python's lock.
    fn with<T: Send>(
        &self,
        py: Python<'_>,
        act: impl FnOnce(&mut Option<ExternalRecorder>) -> PyResult<T> + Send,
    ) -> PyResult<T> {
        self.owner.check("the recording")?;
        py.detach(|| act(&mut self.recorder.lock().unwrap_or_else(PoisonError::into_inner)))
    }

    /// Records an episode. Returns the pose at the end.
    fn add(&self, py: Python<'_>, episode: ExternalEpisode) -> PyResult<(f64, f64, f64)> {
        self.with(py, |recorder| {
            let closed = || invalid("the recording is closed");
            let recorder = recorder.as_mut().ok_or_else(closed)?;
            let end = recorder.record(episode).map_err(invalid)?.robot_in_map;
            let at = end.translation;
            Ok((at.x, at.y, end.rotation.angle()))
        })
    }
}

impl Drop for Recording {
    /// A forked process leaves the files to its parent.
    fn drop(&mut self) {
        if !self.owner.is_this() {
            let recorder = self.recorder.get_mut();
            std::mem::forget(recorder.unwrap_or_else(PoisonError::into_inner).take());
        }
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
    let source = RecordedRun::of(file)?;
    Repetition::new(&source, &mut ())?.difference(&source)
}
