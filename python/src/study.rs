//! Studies that compare agents of Python with the methods of the program.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use xcscr::study::{Agents, Protocol, Report, StudyFile, StudyFolder};

use crate::external::{External, Fault};
use crate::plan::{invalid, warn};

/// The origin that messages name.
const ORIGIN: &str = "study";

/// A finished study.
#[pyclass(frozen, module = "xcscr._native")]
pub struct Study {
    agents: Agents,
    /// The folder of the study, which stays unlocked between two calls.
    folder: PathBuf,
    fault: Fault,
}

/// Stores the exception of a signal, such as that of Ctrl-C.
fn check_signals(fault: &Fault) {
    if let Err(error) = Python::attach(|py| py.check_signals()) {
        fault.set(error);
    }
}

/// Runs a study file with agents of Python in addition, and compares `reference` with each other method. Writes tables, report and figures to the folder `out`.
/// Calls `progress` after each trial.
#[pyfunction]
pub fn run_study(
    py: Python<'_>,
    text: &str,
    agents: Vec<(String, Py<PyAny>)>,
    reference: Option<&str>,
    out: PathBuf,
    jobs: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<Study> {
    let mut file = StudyFile::parse(text, ORIGIN, Path::new("")).map_err(invalid)?;
    file.reference = reference.map(str::to_owned).or(file.reference);
    let fault = Fault::default();
    let mut added = Agents::default();
    for (name, class) in agents {
        let fault = fault.clone();
        let build = move |plan: &_| Box::new(External::new(&class, plan, fault.clone())) as Box<_>;
        added = added.with(&name, build).map_err(invalid)?;
    }
    let protocol = Protocol::new(&file, &added).map_err(invalid)?;
    warn(py, protocol.arm_plans())?;
    let mut watch = |finished, trials| {
        check_signals(&fault);
        if let Some(progress) = progress.as_ref().filter(|_| finished > 0) {
            let called = Python::attach(|py| progress.call1(py, (finished, trials)).map(drop));
            called.unwrap_or_else(|error| fault.set(error));
        }
        if fault.is_set() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let ran = py.detach(|| {
        let mut folder = StudyFolder::open(&out, protocol, false)?.with_agents(added.clone());
        // An exception of an agent interrupts a study, and is no result.
        folder.retry_failed()?;
        folder.run(jobs, &mut watch)?;
        Ok::<_, xcscr::Error>(folder)
    });
    fault.check()?;
    let folder = ran.map_err(invalid)?;
    refuse_failed(&folder)?;
    let written = py.detach(|| Report::new(&folder).write());
    written.map_err(invalid)?;
    Ok(Study {
        agents: added,
        folder: out,
        fault,
    })
}

fn refuse_failed(folder: &StudyFolder) -> PyResult<()> {
    let mut faults = folder
        .records()
        .filter_map(|record| record.result.as_ref().err());
    faults.next().map_or(Ok(()), |first| {
        let (count, path) = (1 + faults.count(), folder.path().display());
        Err(PyRuntimeError::new_err(format!(
            "{count} trials in {path} failed; the first: {first}; the same call repeats them"
        )))
    })
}

#[pymethods]
impl Study {
    /// The report as text for a terminal.
    fn report(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| {
            let folder = StudyFolder::read(&self.folder).map_err(invalid)?;
            Ok(Report::new(&folder).terminal())
        })
    }

    /// Repeats the trials, and writes the table of episodes and the learning curves to the folder of the study.
    fn write_episodes(&self, py: Python<'_>, jobs: usize) -> PyResult<()> {
        let stop = || {
            check_signals(&self.fault);
            self.fault.is_set()
        };
        let written = py.detach(|| {
            let folder = StudyFolder::read_locked(&self.folder)?;
            let folder = folder.with_agents(self.agents.clone());
            folder.write_episodes(jobs, &stop)
        });
        self.fault.check()?;
        written.map_err(invalid)
    }
}
