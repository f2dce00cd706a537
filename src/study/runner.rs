//! Runs the trials of a study on several threads.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::thread;

use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use super::error::StudyError;
use super::protocol::Protocol;
use super::store::Shard;
use super::store::TrialRecord;
use super::store::folder::{OpenFolder, StudyFolder};

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

/// Runs what is missing of one shard of a study in the folder `out`, on `jobs` threads (all
/// cores when 0). The results do not depend on `jobs`.
///
/// # Errors
/// When the folder holds another study, is in use, or cannot be written.
pub fn run_study(
    protocol: &Protocol,
    out: &Path,
    shard: Shard,
    jobs: usize,
    watcher: &mut dyn StudyWatcher,
) -> Result<StudyFolder, StudyError> {
    let mut open = OpenFolder::open(out, protocol)?;
    let mut trials = open.folder().missing();
    trials.retain(|trial| shard.holds(*trial));
    watcher.begins(trials.len());
    let pool = ThreadPoolBuilder::new()
        .num_threads(jobs)
        .build()
        .map_err(|fault| {
            let fault = fault.to_string();
            StudyError::Jobs { jobs, fault }
        })?;
    run_trials(&pool, protocol, &trials, &mut open, watcher)?;
    open.close()
}

/// Joins folders of one study, which must be complete together, into the folder `out`.
///
/// # Errors
/// [`StudyError::Mixed`], [`StudyError::Incomplete`], or an error of a folder.
pub fn merge_studies(folders: &[PathBuf], out: &Path) -> Result<StudyFolder, StudyError> {
    let joined = StudyFolder::join(folders)?;
    joined.require_complete()?;
    let mut open = OpenFolder::open(out, joined.protocol())?;
    open.add_all(&joined)?;
    open.close()
}

fn run_trials(
    pool: &ThreadPool,
    protocol: &Protocol,
    trials: &[usize],
    open: &mut OpenFolder,
    watcher: &mut dyn StudyWatcher,
) -> Result<(), StudyError> {
    let stop = AtomicBool::new(false);
    let (sender, receiver) = channel();
    let run = || {
        pool.install(|| {
            // One at a time: trials take long, and the last ones should not wait in line.
            trials
                .par_iter()
                .with_max_len(1)
                .for_each_with(sender, |sender, &trial| {
                    if !stop.load(Ordering::Relaxed) {
                        // Nobody listens any more only after an error, which stops us too.
                        let _ = sender.send(TrialRecord::of(protocol, trial));
                    }
                });
        });
    };
    thread::scope(|scope| {
        let spawned = thread::Builder::new().spawn_scoped(scope, run);
        spawned.map_err(|fault| StudyError::Jobs {
            jobs: pool.current_num_threads(),
            fault: fault.to_string(),
        })?;
        let kept = keep(&receiver, open, watcher, &stop);
        stop.store(true, Ordering::Relaxed);
        kept
    })
}

/// Keeps records as they come, all that wait at once, until there are no more.
fn keep(
    receiver: &Receiver<TrialRecord>,
    open: &mut OpenFolder,
    watcher: &mut dyn StudyWatcher,
    stop: &AtomicBool,
) -> Result<(), StudyError> {
    while let Ok(first) = receiver.recv() {
        let records: Vec<TrialRecord> = std::iter::once(first).chain(receiver.try_iter()).collect();
        open.add(records.clone())?;
        if records
            .iter()
            .any(|record| watcher.finished(record).is_break())
        {
            stop.store(true, Ordering::Relaxed);
        }
    }
    Ok(())
}
