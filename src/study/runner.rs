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

/// Receives the progress of a study.
pub trait StudyWatcher {
    /// Called before `trials` trials are run.
    fn begins(&mut self, trials: usize) {
        let _ = trials;
    }

    /// Called when a trial is finished and stored. `Break` ends the study after the running trials.
    fn finished(&mut self, record: &TrialRecord) -> ControlFlow<()> {
        let _ = record;
        ControlFlow::Continue(())
    }
}

impl StudyWatcher for () {}

impl StudyFolder {
    /// Merges folders of one study, which must be complete together, into the folder `out`.
    ///
    /// # Errors
    /// [`StudyError::Mixed`], [`StudyError::Incomplete`], or an error of a folder.
    pub fn merge(folders: &[PathBuf], out: &Path) -> Result<Self, StudyError> {
        write_merged(&Self::join(folders)?, out)
    }
}

/// Writes a complete study to the folder `out`.
pub(super) fn write_merged(joined: &StudyFolder, out: &Path) -> Result<StudyFolder, StudyError> {
    joined.require_complete()?;
    let mut open = OpenFolder::open(out, joined.protocol())?;
    open.add_all(joined)?;
    open.close()
}

/// A store for finished trials.
pub(super) trait RecordStore {
    /// Writes records so that they survive when the process is killed.
    fn write(&mut self, records: &[TrialRecord]) -> Result<(), StudyError>;

    /// Flushes the written records to the disk, so that they survive a crash of the machine.
    fn sync(&mut self) -> Result<(), StudyError>;
}

impl RecordStore for OpenFolder {
    fn write(&mut self, records: &[TrialRecord]) -> Result<(), StudyError> {
        self.write(records)
    }

    fn sync(&mut self) -> Result<(), StudyError> {
        self.sync()
    }
}

impl RecordStore for Journal {
    fn write(&mut self, records: &[TrialRecord]) -> Result<(), StudyError> {
        self.write(records)
    }

    fn sync(&mut self) -> Result<(), StudyError> {
        self.sync()
    }
}

/// A finished trial, and the channel of the thread that waits until the trial is written.
type Finished = (TrialRecord, SyncSender<()>);

/// Runs trials on `jobs` threads (all cores when 0). A thread begins its next trial when its last
/// one is written, so a killed process loses at most one trial per thread.
pub(super) fn run_trials(
    study: (&Protocol, &Agents),
    trials: &[usize],
    jobs: usize,
    store: &mut dyn RecordStore,
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
        let stored = store_all(receiver, store, watcher, &stop);
        stop.store(true, Ordering::Relaxed);
        stored
    })
}

/// Runs trials on the threads of the current pool until `stop` is set.
fn run_each(
    (protocol, agents): (&Protocol, &Agents),
    trials: &[usize],
    sender: Sender<Finished>,
    stop: &AtomicBool,
) {
    // One at a time: trials take long, and the last ones should not queue behind each other.
    let trials = trials.par_iter().with_max_len(1);
    trials.for_each_with(sender, |sender, &trial| {
        if !stop.load(Ordering::Relaxed) {
            let (stored, wait) = sync_channel(0);
            // The channels are closed only after an error, which also sets `stop`.
            let _ = sender.send((TrialRecord::of(protocol, agents, trial), stored));
            let _ = wait.recv();
        }
    });
}

/// Writes records as they arrive, all waiting records at once, until the channel is closed.
fn store_all(
    receiver: Receiver<Finished>,
    store: &mut dyn RecordStore,
    watcher: &mut dyn StudyWatcher,
    stop: &AtomicBool,
) -> Result<(), StudyError> {
    while let Ok(first) = receiver.recv() {
        let finished = std::iter::once(first).chain(receiver.try_iter());
        let (records, waiting): (Vec<TrialRecord>, Vec<_>) = finished.unzip();
        store.write(&records)?;
        for record in &records {
            if watcher.finished(record).is_break() {
                stop.store(true, Ordering::Relaxed);
            }
        }
        drop(waiting);
        store.sync()?;
    }
    Ok(())
}
