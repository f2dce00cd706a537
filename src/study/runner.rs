//! Runs the trials of a study on several threads.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread;

use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use super::custom::Agents;
use super::error;
use super::protocol::Protocol;
use super::store::{Journal, Records, StudyFolder, TrialRecord};
use crate::Error;

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

/// A finished trial, and the channel of the thread that waits until the trial is written.
type Finished = (TrialRecord, SyncSender<()>);

/// Runs the missing trials of a task on `jobs` threads (all cores when 0), and stores them in a new
/// journal. A thread begins its next trial when its last one is written, so a killed process loses at
/// most one trial per thread.
pub(super) fn run_trials(
    folder: &mut StudyFolder,
    agents: &Agents,
    task: usize,
    jobs: usize,
    watcher: &mut dyn StudyWatcher,
) -> Result<(), Error> {
    let trials = folder.missing_of(task);
    if trials.is_empty() {
        return Ok(());
    }
    let pool = threads(jobs)?;
    let StudyFolder {
        planned, records, ..
    } = folder;
    let mut journal = planned.begin(task)?;
    let protocol = planned.protocol();
    let stop = AtomicBool::new(false);
    let (sender, receiver) = channel();
    thread::scope(|scope| {
        let run = || pool.install(|| run_each(protocol, agents, &trials, sender, &stop));
        let spawned = thread::Builder::new().spawn_scoped(scope, run);
        spawned.map_err(error::jobs(jobs))?;
        let stored = store_all(receiver, &mut journal, records, watcher, &stop);
        stop.store(true, Ordering::Relaxed);
        stored
    })
}

/// Starts `jobs` threads (all cores when 0).
pub(super) fn threads(jobs: usize) -> Result<ThreadPool, Error> {
    let pool = ThreadPoolBuilder::new().num_threads(jobs).build();
    pool.map_err(error::jobs(jobs))
}

/// Runs trials on the threads of the current pool until `stop` is set.
fn run_each(
    protocol: &Protocol,
    agents: &Agents,
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
    journal: &mut Journal,
    finished: &mut Records,
    watcher: &mut dyn StudyWatcher,
    stop: &AtomicBool,
) -> Result<(), Error> {
    while let Ok(first) = receiver.recv() {
        let arrived = std::iter::once(first).chain(receiver.try_iter());
        let (records, waiting): (Vec<TrialRecord>, Vec<_>) = arrived.unzip();
        journal.write(&records)?;
        for record in &records {
            let is_new = finished.insert(record);
            debug_assert!(is_new, "only missing trials are run");
            if watcher.finished(record).is_break() {
                stop.store(true, Ordering::Relaxed);
            }
        }
        drop(waiting);
        journal.sync()?;
    }
    Ok(())
}
