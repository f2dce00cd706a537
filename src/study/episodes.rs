//! A table row for each episode of a study, and learning curves, computed by running its trials
//! again.
//!
//! A trial is determined by its plan, so a study stores nothing about episodes while it runs. The
//! rows are the same for any number of threads, tasks and machines.

use std::io;

use flate2::Compression;
use flate2::write::GzEncoder;
use rayon::ThreadPool;
use rayon::prelude::*;
use serde::Serialize;

use super::analysis::learning::CurveSums;
use super::custom::Agents;
use super::protocol::Protocol;
use super::report::Report;
use super::runner::threads;
use super::store::outputs::{EPISODES, LEARNING_CURVES, io_error};
use super::store::{StudyFolder, TrialRecord};
use crate::Error;
use crate::episode::{Ending, Episode};
use crate::trial::Trial;

/// Trials per thread in one batch. Their rows stay in memory until they are written in order.
const TRIALS_PER_THREAD: usize = 4;

/// A row of the episode table. Fields without a value are empty.
#[derive(Debug, Serialize)]
struct EpisodeRow {
    world: String,
    method: String,
    arena: &'static str,
    sensor: &'static str,
    variant: String,
    /// From 1, as in `trials.csv`.
    trial: usize,
    seed: u64,
    /// From 1.
    episode: u32,
    steps: u32,
    collisions: u32,
    explored: u32,
    reward: f64,
    /// Whether the episode ended at a goal.
    reached: bool,
    /// Steps of the greedy policy from the start after the episode. Empty if the policy does not
    /// reach a goal, or if episodes start anywhere.
    greedy_steps: Option<usize>,
    /// Whether the greedy policy is globally optimal after the episode.
    optimal: bool,
}

impl EpisodeRow {
    fn new(protocol: &Protocol, number: usize, trial: &Trial, episode: &Episode) -> Self {
        let plan = trial.plan();
        let path = trial.greedy_path();
        let arrives = |path: &Vec<_>| path.last().is_some_and(|&cell| plan.maze.is_goal(cell));
        Self {
            world: plan.maze.name().to_owned(),
            method: protocol.arm(number).method_name().to_owned(),
            arena: plan.config.arena.name(),
            sensor: plan.config.sensor.name(),
            variant: protocol.arm(number).variant.to_string(),
            trial: protocol.replicate(number),
            seed: plan.config.seed,
            episode: episode.episode,
            steps: episode.steps,
            collisions: episode.collisions,
            explored: episode.explored,
            reward: episode.reward,
            reached: episode.ending == Ending::Goal,
            greedy_steps: path.filter(arrives).map(|path| path.len() - 1),
            optimal: trial.progress().optimal,
        }
    }
}

impl StudyFolder {
    /// Runs the trials of a complete study again. Writes a row for each episode to `episodes.csv.gz` in
    /// the study's folder, in the order of the trials. Writes the means to `learning-curves.csv`,
    /// and the report anew, which plots them. A failed trial has no rows. `stop` is called between
    /// batches of trials.
    ///
    /// # Errors
    /// When trials are missing, the report was changed by hand, the threads cannot be started, this program lacks an agent of the study, a trial has another result
    /// than the stored one, a file has other contents or cannot be written, or `stop` returned true.
    pub fn write_episodes(&self, jobs: usize, stop: &dyn Fn() -> bool) -> Result<(), Error> {
        self.require_complete()?;
        let protocol = self.protocol();
        self.agents.require_for(protocol)?;
        let mut report = Report::new(self);
        report.write_report()?;
        let curves = self.write_episode_table(jobs, stop)?;
        // The report has no learning curves yet. An interrupted command can be repeated without it.
        self.remove_reports()?;
        self.write_with(LEARNING_CURVES, |file| {
            let mut table = csv::Writer::from_writer(file);
            let arms = protocol.arms.iter().zip(&curves);
            for point in arms.flat_map(|(arm, sums)| sums.points(arm)) {
                table.serialize(point).map_err(io_error)?;
            }
            table.flush()
        })?;
        report.write_report()
    }

    /// Writes the table of episodes, and returns the sums of the learning curve of each arm.
    fn write_episode_table(
        &self,
        jobs: usize,
        stop: &dyn Fn() -> bool,
    ) -> Result<Vec<CurveSums>, Error> {
        let pool = threads(jobs)?;
        let mut sums: Vec<CurveSums> = Vec::new();
        sums.resize_with(self.protocol().arms.len(), CurveSums::default);
        let mut differs = None;
        let written = self.write_with(EPISODES, |file| {
            let mut table = csv::Writer::from_writer(GzEncoder::new(file, Compression::default()));
            let mut add = |repeated: &Repeated| {
                if let Err(fault) = self.require_equal(&repeated.record) {
                    differs = Some(fault);
                    return Err(io::ErrorKind::Other.into());
                }
                let Repeated { record, rows } = repeated;
                if !rows.is_empty() {
                    let arm = record.trial / self.protocol().trials;
                    sums[arm].add(rows.iter().map(|row| row.steps));
                }
                let mut rows = rows.iter();
                rows.try_for_each(|row| table.serialize(row))
                    .map_err(io_error)
            };
            self.repeat_each(&pool, stop, &mut add)?;
            let packed = table.into_inner().map_err(|fault| fault.into_error())?;
            packed.finish().map(|_| ())
        });
        differs.map_or(Ok(()), Err)?;
        written.map(|()| sums)
    }

    /// Repeats all trials, and calls `each` with them in their order.
    fn repeat_each(
        &self,
        pool: &ThreadPool,
        stop: &dyn Fn() -> bool,
        each: &mut dyn FnMut(&Repeated) -> io::Result<()>,
    ) -> io::Result<()> {
        let trials: Vec<usize> = (0..self.protocol().len()).collect();
        for trials in trials.chunks(TRIALS_PER_THREAD * pool.current_num_threads()) {
            if stop() {
                return Err(io::ErrorKind::Interrupted.into());
            }
            let repeat = |&trial: &usize| Repeated::new(self.protocol(), &self.agents, trial);
            let all: Vec<Repeated> = pool.install(|| trials.par_iter().map(repeat).collect());
            all.iter().try_for_each(&mut *each)?;
        }
        Ok(())
    }
}

/// A repeated trial.
struct Repeated {
    record: TrialRecord,
    /// A row for each episode. Empty if the trial failed.
    rows: Vec<EpisodeRow>,
}

impl Repeated {
    fn new(protocol: &Protocol, agents: &Agents, number: usize) -> Self {
        let mut rows = Vec::new();
        let each = &mut |trial: &Trial, episode: &Episode| {
            rows.push(EpisodeRow::new(protocol, number, trial, episode));
        };
        let record = TrialRecord::of_episodes(protocol, agents, number, each);
        if record.result.is_err() {
            rows.clear();
        }
        Self { record, rows }
    }
}
