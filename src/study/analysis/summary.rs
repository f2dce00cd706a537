//! The summary of the trials of each arm.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use serde::Serialize;

use super::memoryless;
use crate::episode::Mistakes;
use crate::streams::StreamName;
use crate::study::protocol::Arm;
use crate::study::statistics::{
    Interval, Pairs, Proportion, bootstrap_interval, quantile, rounded,
};
use crate::study::store::StudyFolder;
use crate::study::store::{Driven, Figures};
use crate::trial::Settings;
use xcs::random::Stream;

/// The finished trials of one arm.
#[derive(Debug, Clone)]
pub struct ArmRecords<'a> {
    /// The arm.
    pub arm: &'a Arm,
    /// Number of failed trials.
    pub failed: usize,
    /// Whether no policy without memory is optimal.
    pub needs_memory: bool,
    /// The figures of each trial; `None` if the trial failed or is missing.
    trials: Vec<Option<&'a Figures>>,
}

impl<'a> ArmRecords<'a> {
    /// Returns the finished trials of each arm of a study.
    pub fn all(folder: &'a StudyFolder) -> Vec<Self> {
        let protocol = folder.protocol();
        let mut known = BTreeMap::new();
        let mut needs_memory = |i: usize, arm: &Arm| {
            let Settings { arena, sensor, .. } = &arm.settings;
            let percept = (arm.sensor.name(), sensor.history);
            let place = (arm.world.clone(), percept, arena.slip.to_bits());
            let search = || memoryless::needs_memory(&protocol.plan(i * protocol.trials));
            *known.entry(place).or_insert_with(search)
        };
        let arms = protocol.arms.iter().enumerate();
        arms.map(|(i, arm)| Self::new(folder, i, arm, needs_memory(i, arm)))
            .collect()
    }

    fn new(folder: &'a StudyFolder, i: usize, arm: &'a Arm, needs_memory: bool) -> Self {
        let trials = folder.protocol().trials;
        let own = (i * trials..(i + 1) * trials).map(|trial| folder.record(trial));
        let failed = own.clone().flatten();
        Self {
            arm,
            failed: failed.filter(|record| record.result.is_err()).count(),
            needs_memory,
            trials: own.map(|record| record?.figures()).collect(),
        }
    }

    /// Returns the figures of the trials that did not fail.
    fn figures(&self) -> impl Iterator<Item = &'a Figures> {
        self.trials.iter().copied().flatten()
    }

    /// Returns the proportion of trials that found a globally optimal policy.
    pub fn successes(&self) -> Proportion {
        let successes = self.first_episodes().len() as u64;
        Proportion::new(successes, self.figures().count() as u64)
    }

    /// Returns the first optimal episodes of the trials that have one, in ascending order.
    pub fn first_episodes(&self) -> Vec<u32> {
        let firsts = self
            .figures()
            .filter_map(|one| one.progress.first_optimal_episode);
        let mut firsts: Vec<u32> = firsts.collect();
        firsts.sort_unstable();
        firsts
    }

    /// Returns the environment steps of the first optimal policy of the trials that have one.
    pub fn first_env_steps(&self) -> impl Iterator<Item = f64> + '_ {
        let firsts = self
            .figures()
            .map(|one| one.progress.first_optimal_env_steps);
        firsts.flatten().map(|steps| steps as f64)
    }

    /// Returns the environment steps of the longest trial.
    pub fn most_steps(&self) -> u64 {
        let steps = self.figures().map(|one| one.progress.steps);
        steps.max().unwrap_or(0)
    }

    /// Returns the share of trials that had found an optimal policy, with Wilson's interval, from
    /// each of these times on. `firsts` are the times of the solved trials, in ascending order.
    pub fn solved_by(&self, firsts: &[f64]) -> Vec<(f64, Interval)> {
        let trials = self.successes().trials;
        let solved = |count: usize| Proportion::new(count as u64, trials).wilson();
        let mut steps = vec![(0.0, solved(0))];
        let counts = 1..=firsts.len();
        let ends = counts.filter(|&count| firsts.get(count) != Some(&firsts[count - 1]));
        steps.extend(ends.map(|count| (firsts[count - 1], solved(count))));
        steps
    }

    /// Returns the first episode by which all trials but `percent` % were optimal.
    fn episode_when_left(&self, percent: usize) -> Option<u32> {
        let trials = self.figures().count();
        let needed = trials - trials * percent / 100;
        let firsts = self.first_episodes();
        firsts.get(needed.checked_sub(1)?).copied()
    }

    /// Pairs the trials of two arms with the same seeds, and counts the pairs by the result of
    /// `better` for the first and the second. Failed trials are in no pair.
    pub fn pairs(&self, other: &Self, better: impl Fn(&Figures, &Figures) -> Ordering) -> Pairs {
        let mut pairs = Pairs::default();
        for (ours, theirs) in self.trials.iter().zip(&other.trials) {
            if let (Some(ours), Some(theirs)) = (ours, theirs) {
                pairs.add(better(ours, theirs));
            }
        }
        pairs
    }

    /// Returns the steps in the environment until the policy was optimal, or else until the end.
    fn env_steps(&self) -> Vec<f64> {
        let figures = self.figures().map(|one| &one.progress);
        figures
            .map(|one| one.first_optimal_env_steps.unwrap_or(one.steps) as f64)
            .collect()
    }

    /// Returns the interquartile mean of these steps with its bootstrap interval. Each arm restarts
    /// the stream of `seed`, so its interval does not depend on the other arms.
    fn iqm_env_steps(&self, seed: u64) -> Option<Interval> {
        bootstrap_interval(
            &self.env_steps(),
            &mut Stream::new(seed, StreamName::Bootstrap),
        )
    }

    /// Returns the number of rules after compaction for each retained trial.
    fn compacted_rules(&self) -> Vec<f64> {
        let retained = self.figures().filter(|one| one.progress.optimal);
        let counts = retained.filter_map(|one| one.compacted_rules);
        counts.map(|count| count as f64).collect()
    }

    fn greedy_steps(&self) -> impl Iterator<Item = f64> + '_ {
        self.figures().filter_map(|one| one.greedy_steps)
    }

    /// Returns the rounded mean of a figure over the trials that have it, or `None` if none has.
    fn mean_of(&self, figure: impl Fn(&Figures) -> Option<f64>) -> Option<f64> {
        let known: Vec<f64> = self.figures().filter_map(figure).collect();
        let sum: f64 = known.iter().sum();
        (!known.is_empty()).then(|| rounded(sum / known.len() as f64))
    }

    /// Returns the proportion of trials whose policy reached a goal in every episode driven at the
    /// end. `None` if no trial drove.
    fn driven_always(&self) -> Option<Proportion> {
        let driven: Vec<Driven> = self.figures().filter_map(|one| one.driven).collect();
        let always = driven.iter().filter(|one| one.goals == one.episodes);
        let always = Proportion::new(always.count() as u64, driven.len() as u64);
        (!driven.is_empty()).then_some(always)
    }

    /// Returns the number of trials whose policy was optimal after the last episode.
    pub fn retained(&self) -> u64 {
        let retained = self.figures().filter(|one| one.progress.optimal);
        retained.count() as u64
    }

    /// Returns the mean share of optimal episodes after the first optimal one.
    pub fn mean_share_after_first(&self) -> Option<f64> {
        let figures = self.figures();
        let shares = figures.filter_map(|one| one.progress.optimal_share_after_first());
        let (count, sum) = shares.fold((0, 0.0), |(count, sum), share| (count + 1, sum + share));
        (count > 0).then(|| rounded(sum / f64::from(count)))
    }

    /// Returns the steps with some mistake as a share of all steps of all trials. `None` if there
    /// are none.
    fn share_of_steps(&self, mistakes: impl Fn(&Mistakes) -> u64) -> Option<f64> {
        let progress = || self.figures().map(|one| &one.progress);
        let found: f64 = progress().map(|one| mistakes(&one.mistakes) as f64).sum();
        let steps: f64 = progress().map(|one| one.steps as f64).sum();
        (found > 0.0).then(|| rounded(found / steps.max(1.0)))
    }
}

/// Orders trials by success: a trial whose policy became optimal is better.
pub fn by_success(one: &Figures, other: &Figures) -> Ordering {
    let is_optimal = |one: &Figures| one.progress.first_optimal_episode.is_some();
    is_optimal(one).cmp(&is_optimal(other))
}

/// Orders trials by the steps until the policy became optimal: fewer is better, and never is worst.
pub fn by_steps(one: &Figures, other: &Figures) -> Ordering {
    let steps = |one: &Figures| one.progress.first_optimal_env_steps.unwrap_or(u64::MAX);
    steps(other).cmp(&steps(one))
}

/// Orders trials by the score of the greedy policy at the end.
pub fn by_score(one: &Figures, other: &Figures) -> Ordering {
    let score = |one: &Figures| one.greedy_score.map_or(0.0, rounded);
    score(one).total_cmp(&score(other))
}

/// A row of `summary.json`. Numbers are rounded to six decimals, because the last digits of
/// logarithms differ between machines.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ArmSummary {
    /// The world's name.
    pub world: String,
    /// The learning method.
    pub method: String,
    /// The arena.
    pub arena: &'static str,
    /// The sensor.
    pub sensor: &'static str,
    /// The settings of the sweep; empty without a sweep.
    pub variant: String,
    /// Whether no policy without memory is optimal, because cells share a percept.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub needs_memory: bool,
    /// Finished trials that did not fail.
    pub trials: u64,
    /// Trials that failed.
    pub failed: usize,
    /// Trials that found a globally optimal policy.
    pub successes: u64,
    /// Lower 95 % limit of their share (Wilson).
    pub wilson_low: f64,
    /// Upper 95 % limit of their share (Wilson).
    pub wilson_high: f64,
    /// The first episode by which half of all trials were optimal; `null` when
    /// fewer ever were.
    pub median_episode: Option<u32>,
    /// The first episode by which 95 % of all trials were optimal; `null` when fewer ever were.
    pub p95_episode: Option<u32>,
    /// The median first optimal episode of the successful trials alone.
    pub median_episode_of_successes: Option<f64>,
    /// Trials whose policy was also optimal after the last episode.
    pub retained: u64,
    /// Of the episodes after the first optimal one, the mean share after which the policy was
    /// optimal again. The mean is over the trials that have such episodes; `null` when none has.
    pub mean_optimal_share_after_first: Option<f64>,
    /// Trials with an executed episode as short as a shortest path.
    pub executed_optimal: u64,
    /// Interquartile mean of the environment steps until the policy was optimal. Trials that were
    /// never optimal count with all their steps.
    pub iqm_env_steps: Option<f64>,
    /// Lower bootstrap 95 % limit of `iqm_env_steps`.
    pub iqm_env_steps_low: Option<f64>,
    /// Upper bootstrap 95 % limit of `iqm_env_steps`.
    pub iqm_env_steps_high: Option<f64>,
    /// Mean steps per trial. `null` when all trials failed, like the next two.
    pub mean_steps: Option<f64>,
    /// Mean collisions per trial.
    pub mean_collisions: Option<f64>,
    /// Share of all steps at which the percept had an observation error. Absent if no step had one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub observation_error_share: Option<f64>,
    /// Share of all steps after which the robot was mislocalised. Absent if there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mislocalised_share: Option<f64>,
    /// Mean number of rules at the end.
    pub mean_rules: Option<f64>,
    /// Mean over all trials of the greedy policy's mean steps from all starts, at the end.
    pub mean_greedy_steps: Option<f64>,
    /// The largest of these values in any trial.
    pub most_greedy_steps: Option<f64>,
    /// Mean of the greedy steps as a multiple of the optimum; `null` where the optimum is unknown.
    pub mean_greedy_ratio: Option<f64>,
    /// Mean score of the greedy policy at the end; `null` where the optimum is unknown.
    pub mean_greedy_score: Option<f64>,
    /// Share of the episodes driven by the greedy policy at the end that reached a goal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub driven_goals: Option<f64>,
    /// Trials in which all of these episodes reached a goal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub driven_always: Option<u64>,
    /// Lower 95 % limit of the share of `driven_always` trials (Wilson).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub driven_always_low: Option<f64>,
    /// Upper 95 % limit of the share of `driven_always` trials (Wilson).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub driven_always_high: Option<f64>,
    /// Share of the driven episodes that reached a goal in the minimum number of steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub driven_optimal: Option<f64>,
    /// Mean steps of the driven episodes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub driven_steps: Option<f64>,
    /// Median number of rules of the retained trials after compaction; `null` for tables.
    pub median_compacted_rules: Option<f64>,
    /// Maximum number of rules of a retained trial after compaction.
    pub most_compacted_rules: Option<usize>,
}

impl ArmSummary {
    /// Summarises the finished trials of an arm. `seed` is that of the study.
    pub fn new(records: &ArmRecords<'_>, seed: u64) -> Self {
        let arm = records.arm;
        let successes = records.successes();
        let wilson = successes.wilson().rounded();
        let firsts: Vec<f64> = records
            .first_episodes()
            .into_iter()
            .map(f64::from)
            .collect();
        let iqm = records.iqm_env_steps(seed).map(Interval::rounded);
        let compacted = records.compacted_rules();
        let always = records.driven_always();
        let reliable = always.map(|always| always.wilson().rounded());
        let count =
            |is: &dyn Fn(&Figures) -> bool| records.figures().filter(|one| is(one)).count() as u64;
        Self {
            world: arm.world.clone(),
            method: arm.method_name().to_owned(),
            arena: arm.arena.name(),
            sensor: arm.sensor.name(),
            variant: arm.variant.to_string(),
            needs_memory: records.needs_memory,
            trials: successes.trials,
            failed: records.failed,
            successes: successes.successes,
            wilson_low: wilson.low,
            wilson_high: wilson.high,
            median_episode: records.episode_when_left(50),
            p95_episode: records.episode_when_left(5),
            median_episode_of_successes: quantile(&firsts, 0.5),
            retained: records.retained(),
            mean_optimal_share_after_first: records.mean_share_after_first(),
            executed_optimal: count(&|one| one.progress.first_executed_optimal_episode.is_some()),
            iqm_env_steps: iqm.map(|iqm| iqm.value),
            iqm_env_steps_low: iqm.map(|iqm| iqm.low),
            iqm_env_steps_high: iqm.map(|iqm| iqm.high),
            mean_steps: records.mean_of(|one| Some(one.progress.steps as f64)),
            mean_collisions: records.mean_of(|one| Some(one.progress.collisions as f64)),
            observation_error_share: records.share_of_steps(|one| one.observation_error),
            mislocalised_share: records.share_of_steps(|one| one.mislocalised),
            mean_rules: records.mean_of(|one| Some(one.rules as f64)),
            mean_greedy_steps: records.mean_of(|one| one.greedy_steps),
            most_greedy_steps: records.greedy_steps().reduce(f64::max).map(rounded),
            mean_greedy_ratio: records.mean_of(|one| one.greedy_ratio),
            mean_greedy_score: records.mean_of(|one| one.greedy_score),
            driven_goals: records.mean_of(|one| one.driven.map(|d| d.share(d.goals))),
            driven_always: always.map(|always| always.successes),
            driven_always_low: reliable.map(|share| share.low),
            driven_always_high: reliable.map(|share| share.high),
            driven_optimal: records.mean_of(|one| one.driven.map(|d| d.share(d.optimal))),
            driven_steps: records.mean_of(|one| one.driven.map(|d| d.steps)),
            median_compacted_rules: quantile(&compacted, 0.5),
            most_compacted_rules: compacted
                .iter()
                .copied()
                .reduce(f64::max)
                .map(|n| n as usize),
        }
    }
}
