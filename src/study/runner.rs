//! Runs the trials of a study on several threads.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread;

use rayon::ThreadPoolBuilder;
use rayon::prelude::*;

use super::error::StudyError;
use super::own::Agents;
use super::protocol::Protocol;
use super::store::TrialRecord;
use super::store::folder::{OpenFolder, StudyFolder};
use super::store::journal::Journal;

/// Hears how a study goes on.
pub trait StudyWatcher {
    /// So many trials are about to be run.
    fn begins(&mut self, trials: usize) {
        let _ = trials;
    }

    /// A trial was finished and kept. `Break` ends the study after the trials that are running.
    fn finished(&mut self, record: &TrialRecord) -> ControlFlow<()> {
        let _ = record;
        ControlFlow::Continue(())
    }
}

impl StudyWatcher for () {}

impl StudyFolder {
    /// Joins folders of one study, which must be complete together, into the folder `out`.
    ///
    /// # Errors
    /// [`StudyError::Mixed`], [`StudyError::Incomplete`], or an error of a folder.
    pub fn merge(folders: &[PathBuf], out: &Path) -> Result<Self, StudyError> {
        put_together(&Self::join(folders)?, out)
    }
}

/// Puts a study that is complete into the folder `out`.
pub(super) fn put_together(joined: &StudyFolder, out: &Path) -> Result<StudyFolder, StudyError> {
    joined.require_complete()?;
    let mut open = OpenFolder::open(out, joined.protocol())?;
    open.add_all(joined)?;
    open.close()
}

/// What keeps finished trials.
pub(super) trait Keep {
    /// Writes them: a process that is killed loses them no more.
    fn write(&mut self, records: &[TrialRecord]) -> Result<(), StudyError>;

    /// Brings what was written to the disk: a machine that dies loses it no more.
    fn sync(&mut self) -> Result<(), StudyError>;
}

impl Keep for OpenFolder {
    fn write(&mut self, records: &[TrialRecord]) -> Result<(), StudyError> {
        self.write(records)
    }

    fn sync(&mut self) -> Result<(), StudyError> {
        self.sync()
    }
}

impl Keep for Journal {
    fn write(&mut self, records: &[TrialRecord]) -> Result<(), StudyError> {
        self.write(records)
    }

    fn sync(&mut self) -> Result<(), StudyError> {
        self.sync()
    }
}

/// A finished trial, and who waits until it is written.
type Finished = (TrialRecord, SyncSender<()>);

/// Runs trials on `jobs` threads (all cores when 0). A thread begins its next trial when the one
/// before is written, so that whoever kills the process costs each of them one trial at most.
pub(super) fn run_trials(
    study: (&Protocol, &Agents),
    trials: &[usize],
    jobs: usize,
    keep: &mut dyn Keep,
    watcher: &mut dyn StudyWatcher,
) -> Result<(), StudyError> {
    let fault = |fault: String| StudyError::Jobs { jobs, fault };
    let pool = ThreadPoolBuilder::new().num_threads(jobs).build();
    let pool = pool.map_err(|cause| fault(cause.to_string()))?;
    watcher.begins(trials.len());
    let stop = AtomicBool::new(false);
    let (sender, receiver) = channel();
    thread::scope(|scope| {
        let run = || pool.install(|| run_each(study, trials, sender, &stop));
        let spawned = thread::Builder::new().spawn_scoped(scope, run);
        spawned.map_err(|cause| fault(cause.to_string()))?;
        let kept = keep_all(receiver, keep, watcher, &stop);
        stop.store(true, Ordering::Relaxed);
        kept
    })
}

/// Runs trials on the threads of the pool that this is called in, until they are told to stop.
fn run_each(
    (protocol, agents): (&Protocol, &Agents),
    trials: &[usize],
    sender: Sender<Finished>,
    stop: &AtomicBool,
) {
    // One at a time: trials take long, and the last ones should not wait in line.
    let trials = trials.par_iter().with_max_len(1);
    trials.for_each_with(sender, |sender, &trial| {
        if !stop.load(Ordering::Relaxed) {
            let (kept, wait) = sync_channel(0);
            // Nobody listens or answers any more only after an error, which stops us too.
            let _ = sender.send((TrialRecord::of(protocol, agents, trial), kept));
            let _ = wait.recv();
        }
    });
}

/// Keeps records as they come, all that wait at once, until there are no more.
fn keep_all(
    receiver: Receiver<Finished>,
    keep: &mut dyn Keep,
    watcher: &mut dyn StudyWatcher,
    stop: &AtomicBool,
) -> Result<(), StudyError> {
    while let Ok(first) = receiver.recv() {
        let finished = std::iter::once(first).chain(receiver.try_iter());
        let (records, waiting): (Vec<TrialRecord>, Vec<_>) = finished.unzip();
        keep.write(&records)?;
        for record in &records {
            if watcher.finished(record).is_break() {
                stop.store(true, Ordering::Relaxed);
            }
        }
        drop(waiting);
        keep.sync()?;
    }
    Ok(())
}
