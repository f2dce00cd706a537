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
use super::store::{Journal, StudyFolder, TrialRecord};
use crate::Error;

/// Receives the numbers of finished trials and of all trials of a call: before the first trial, and when a trial is
/// finished and stored. `Break` ends the study after the running trials.
pub type Watch<'a> = dyn FnMut(usize, usize) -> ControlFlow<()> + 'a;

/// A finished trial, and the channel of the thread that waits until the trial is written.
type Finished = (TrialRecord, SyncSender<()>);

impl StudyFolder {
    /// Runs the missing trials of the study on `jobs` threads (all cores when
    /// 0). The results do not depend on `jobs`. A smaller study in the folder stays there until the last trial is
    /// finished.
    ///
    /// # Errors
    /// When the folder cannot be written, a file of a smaller study there was
    /// changed by hand, or a custom agent has another result than the one stored.
    pub fn run(&mut self, jobs: usize, watch: &mut Watch<'_>) -> Result<(), Error> {
        self.require_same_agents()?;
        self.require_own_outputs()?;
        self.run_trials(&self.missing(), jobs, watch)?;
        if self.missing().is_empty() {
            self.replace_smaller()
        } else {
            Ok(())
        }
    }

    /// Runs the missing trials of a task, counted from 1, on `jobs` threads (all cores when 0).
    ///
    /// # Errors
    /// When there is no such task, another version of the program made the plan, or the folder
    /// cannot be written.
    pub fn run_task(
        &mut self,
        task: usize,
        jobs: usize,
        watch: &mut Watch<'_>,
    ) -> Result<(), Error> {
        self.require_task(task)?;
        self.require_same_program()?;
        self.run_trials(&self.missing_of_task(task), jobs, watch)
    }

    /// Repeats the first stored trial of each custom agent. A changed agent would mix its results with earlier ones.
    fn require_same_agents(&self) -> Result<(), Error> {
        let protocol = self.protocol();
        self.agents.names().try_for_each(|name| {
            let is_custom = |record: &&TrialRecord| {
                let agent = &protocol.arm(record.trial).agent;
                agent.as_ref() == Some(name) && record.result.is_ok()
            };
            self.records().find(is_custom).map_or(Ok(()), |stored| {
                let repeated = TrialRecord::of(protocol, &self.agents, stored.trial);
                self.require_equal(&repeated)
            })
        })
    }

    /// Runs trials, and stores them in a new
    /// journal. A thread begins its next trial when its last one is written, so a killed process loses at
    /// most one trial per thread.
    fn run_trials(
        &mut self,
        trials: &[usize],
        jobs: usize,
        watch: &mut Watch<'_>,
    ) -> Result<(), Error> {
        if watch(0, trials.len()).is_break() || trials.is_empty() {
            return Ok(());
        }
        let pool = threads(jobs)?;
        let mut journal = self.begin_journal()?;
        // Records are added while the trials run.
        let (protocol, agents) = (self.protocol().clone(), self.agents.clone());
        let stop = AtomicBool::new(false);
        let (sender, receiver) = channel();
        thread::scope(|scope| {
            let run = || pool.install(|| run_each(&protocol, &agents, trials, sender, &stop));
            let spawned = thread::Builder::new().spawn_scoped(scope, run);
            spawned.map_err(error::jobs(jobs))?;
            let mut finished = 0;
            let mut is_over = || {
                finished += 1;
                watch(finished, trials.len()).is_break()
            };
            let stored = self.store_all(receiver, &mut journal, &mut is_over, &stop);
            stop.store(true, Ordering::Relaxed);
            stored
        })
    }

    /// Writes records as they arrive, all waiting records at once, until the channel is closed. `is_over` is
    /// called after each one.
    fn store_all(
        &mut self,
        receiver: Receiver<Finished>,
        journal: &mut Journal,
        is_over: &mut dyn FnMut() -> bool,
        stop: &AtomicBool,
    ) -> Result<(), Error> {
        while let Ok(first) = receiver.recv() {
            let arrived = std::iter::once(first).chain(receiver.try_iter());
            let (records, waiting): (Vec<TrialRecord>, Vec<_>) = arrived.unzip();
            journal.write(&records)?;
            for record in records {
                if is_over() {
                    stop.store(true, Ordering::Relaxed);
                }
                self.add(record);
            }
            drop(waiting);
            journal.sync()?;
        }
        Ok(())
    }
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
