//! What the trials of each arm say together.

use std::cmp::Ordering;
use std::ops::Range;

use serde::Serialize;

use crate::episode::Mistakes;
use crate::streams::StreamName;
use crate::study::protocol::{Arm, Protocol};
use crate::study::statistics::{
    Interval, Lifetime, Pairs, Proportion, Survival, bootstrap_interval, quantile,
};
use crate::study::store::folder::StudyFolder;
use crate::study::store::{Driven, Figures};
use crate::trial::Progress;
use xcs::random::Stream;

/// The finished trials of one arm.
#[derive(Debug, Clone)]
pub struct ArmRecords<'a> {
    /// What they have in common.
    pub arm: &'a Arm,
    /// How many failed.
    pub failed: usize,
    folder: &'a StudyFolder,
    trials: Range<usize>,
    episodes: u32,
}

impl<'a> ArmRecords<'a> {
    /// The finished trials of each arm of a study.
    pub fn all(folder: &'a StudyFolder) -> Vec<Self> {
        let arms = folder.protocol().arms.iter().enumerate();
        arms.map(|(i, arm)| Self::new(folder, i, arm)).collect()
    }

    fn new(folder: &'a StudyFolder, i: usize, arm: &'a Arm) -> Self {
        let Protocol {
            trials, episodes, ..
        } = *folder.protocol();
        let trials = i * trials..(i + 1) * trials;
        let own = folder.records_of(trials.clone());
        let failed = own.filter(|record| record.result.is_err()).count();
        Self {
            arm,
            failed,
            folder,
            trials,
            episodes,
        }
    }

    /// The figures of the trials that did not fail.
    fn figures(&self) -> impl Iterator<Item = Figures> + '_ {
        let own = self.folder.records_of(self.trials.clone());
        own.filter_map(|record| record.result.ok())
    }

    /// The trials that found a globally optimal policy.
    pub fn successes(&self) -> Proportion {
        Proportion {
            successes: self.first_episodes().len() as u64,
            trials: self.figures().count() as u64,
        }
    }

    /// The first optimal episodes of those trials that had one.
    pub fn first_episodes(&self) -> Vec<f64> {
        let firsts = self
            .figures()
            .filter_map(|one| one.progress.first_optimal_episode);
        firsts.map(f64::from).collect()
    }

    /// Episodes until the policy was optimal; trials without one are censored at their end.
    pub fn lifetimes(&self) -> Vec<Lifetime> {
        let lifetime = |one: Figures| {
            let first = one.progress.first_optimal_episode;
            Lifetime {
                time: first.unwrap_or(self.episodes),
                happened: first.is_some(),
            }
        };
        self.figures().map(lifetime).collect()
    }

    /// The pairs of its trials with those of another arm that have the same seeds, counted by what `better` says of the
    /// first in comparison with the second. Trials that failed are in no pair.
    pub fn pairs(&self, other: &Self, better: impl Fn(&Progress, &Progress) -> Ordering) -> Pairs {
        let mut pairs = Pairs::default();
        let [ours, theirs] =
            [self, other].map(|one| one.trials.clone().map(|trial| one.progress(trial)));
        for (ours, theirs) in ours.zip(theirs) {
            if let (Some(ours), Some(theirs)) = (ours, theirs) {
                pairs.add(better(&ours, &theirs));
            }
        }
        pairs
    }

    fn progress(&self, trial: usize) -> Option<Progress> {
        let mut records = self.folder.records_of(trial..trial + 1);
        Some(records.next()?.result.ok()?.progress)
    }

    /// Steps in the environment until the policy was optimal, or else until the end.
    fn env_steps(&self) -> Vec<f64> {
        let figures = self.figures().map(|one| one.progress);
        figures
            .map(|one| one.first_optimal_env_steps.unwrap_or(one.steps) as f64)
            .collect()
    }

    /// The interquartile mean of these steps with its bootstrap interval. Each arm begins the
    /// stream of `seed` anew: its interval is the same whatever stands beside it.
    fn iqm_env_steps(&self, seed: u64) -> Option<Interval> {
        bootstrap_interval(
            &self.env_steps(),
            &mut Stream::new(seed, StreamName::Bootstrap),
        )
    }

    /// Rules that are left of those of the retained trials.
    fn compacted_rules(&self) -> Vec<f64> {
        let retained = self.figures().filter(|one| one.progress.optimal);
        let counts = retained.filter_map(|one| one.compacted_rules);
        counts.map(|count| count as f64).collect()
    }

    fn greedy_steps(&self) -> impl Iterator<Item = f64> + '_ {
        self.figures().filter_map(|one| one.greedy_steps)
    }

    /// The rounded mean of a figure over the trials that have it; `None` if none has.
    fn mean_of(&self, figure: impl Fn(&Figures) -> Option<f64>) -> Option<f64> {
        let known: Vec<f64> = self.figures().filter_map(|one| figure(&one)).collect();
        let sum: f64 = known.iter().sum();
        (!known.is_empty()).then(|| rounded(sum / known.len() as f64))
    }

    /// The trials whose policy reached a goal in every episode that it drove at the end; `None` if
    /// none did drive.
    fn driven_always(&self) -> Option<Proportion> {
        let driven: Vec<Driven> = self.figures().filter_map(|one| one.driven).collect();
        let always = driven.iter().filter(|one| one.goals == one.episodes);
        (!driven.is_empty()).then(|| Proportion {
            successes: always.count() as u64,
            trials: driven.len() as u64,
        })
    }

    /// The trials whose policy was optimal after the last episode.
    pub fn retained(&self) -> u64 {
        let retained = self.figures().filter(|one| one.progress.optimal);
        retained.count() as u64
    }

    /// Of the episodes after the first optimal one, the mean share that was optimal, too.
    pub fn mean_share_after_first(&self) -> Option<f64> {
        let figures = self.figures();
        let shares = figures.filter_map(|one| one.progress.optimal_share_after_first());
        let (count, sum) = shares.fold((0, 0.0), |(count, sum), share| (count + 1, sum + share));
        (count > 0).then(|| rounded(sum / f64::from(count)))
    }

    /// Steps of all trials with some mistake, as a share of all steps; `None` without such steps.
    fn share_of_steps(&self, mistakes: impl Fn(&Mistakes) -> u64) -> Option<f64> {
        let progress = || self.figures().map(|one| one.progress);
        let found: u64 = progress().map(|one| mistakes(&one.mistakes)).sum();
        let steps: u64 = progress().map(|one| one.steps).sum();
        (found > 0).then(|| rounded(found as f64 / steps.max(1) as f64))
    }

    /// The rounded mean of a figure; `None` without trials.
    fn mean(&self, figure: impl Fn(&Figures) -> f64) -> Option<f64> {
        let sum: f64 = self.figures().map(|one| figure(&one)).sum();
        let trials = self.figures().count();
        (trials > 0).then(|| rounded(sum / trials as f64))
    }
}

/// The one whose policy became optimal is better.
pub fn by_success(one: &Progress, other: &Progress) -> Ordering {
    let is_optimal = |progress: &Progress| progress.first_optimal_episode.is_some();
    is_optimal(one).cmp(&is_optimal(other))
}

/// The one whose policy became optimal after fewer steps is better; one that never did is worse than any that did.
pub fn by_steps(one: &Progress, other: &Progress) -> Ordering {
    let steps = |progress: &Progress| progress.first_optimal_env_steps.unwrap_or(u64::MAX);
    steps(other).cmp(&steps(one))
}

/// A row of `summary.json`. Numbers are rounded to six decimals, so that they do not depend on
/// the last digit of a machine's logarithm.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ArmSummary {
    /// The world's name.
    pub world: String,
    /// The reward method.
    pub method: String,
    /// The arena.
    pub arena: &'static str,
    /// The percept.
    pub sensor: &'static str,
    /// What the sweep sets; empty without one.
    pub variant: String,
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
    /// The first episode by which half of all trials were optimal (Kaplan-Meier); `null` when
    /// fewer ever were.
    pub median_episode: Option<u32>,
    /// The first episode by which 95 % of all trials were optimal; `null` when fewer ever were.
    pub p95_episode: Option<u32>,
    /// The median first optimal episode of the successful trials alone.
    pub median_episode_of_successes: Option<f64>,
    /// Trials whose policy was optimal after the last episode, too.
    pub retained: u64,
    /// Of the episodes after the first optimal one, the mean share after which the policy was
    /// optimal, too, over the trials that have such episodes; `null` when none has.
    pub mean_optimal_share_after_first: Option<f64>,
    /// Trials of which an executed episode was as short as a shortest path.
    pub executed_optimal: u64,
    /// Interquartile mean of the environment steps until the policy was optimal; trials without
    /// one count with all their steps.
    pub iqm_env_steps: Option<f64>,
    /// Its lower bootstrap 95 % limit.
    pub iqm_env_steps_low: Option<f64>,
    /// Its upper bootstrap 95 % limit.
    pub iqm_env_steps_high: Option<f64>,
    /// Mean steps of a trial; `null` when all failed, as the next two.
    pub mean_steps: Option<f64>,
    /// Mean collisions of a trial.
    pub mean_collisions: Option<f64>,
    /// Of all steps, the share before which the robot perceived something else than perfect senses
    /// would have; not there where none did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub observation_error_share: Option<f64>,
    /// The share after which it believed to stand in another cell than it did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mislocalised_share: Option<f64>,
    /// Mean number of rules at the end.
    pub mean_rules: Option<f64>,
    /// Mean steps of the greedy policy over all starts at the end, over all trials.
    pub mean_greedy_steps: Option<f64>,
    /// The same of the trial where they are most.
    pub most_greedy_steps: Option<f64>,
    /// Mean of these steps as a multiple of what they are at best; `null` where that is not known.
    pub mean_greedy_ratio: Option<f64>,
    /// Of the episodes in which the greedy policy drove at the end, the share that reached a goal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub driven_goals: Option<f64>,
    /// Trials of which every one of them did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub driven_always: Option<u64>,
    /// Lower 95 % limit of the share of these trials (Wilson).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub driven_always_low: Option<f64>,
    /// Upper 95 % limit of their share (Wilson).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub driven_always_high: Option<f64>,
    /// The share that did so in as few steps as possible.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub driven_optimal: Option<f64>,
    /// Mean steps of these episodes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub driven_steps: Option<f64>,
    /// The median number of rules that are left of those of the retained trials when they are
    /// compacted; `null` for tables.
    pub median_compacted_rules: Option<f64>,
    /// The most of them.
    pub most_compacted_rules: Option<usize>,
}

impl ArmSummary {
    /// The summary of each arm of a study.
    pub fn all(folder: &StudyFolder) -> Vec<Self> {
        let seed = folder.protocol().seed;
        let arms = ArmRecords::all(folder);
        arms.iter().map(|arm| Self::new(arm, seed)).collect()
    }

    fn new(records: &ArmRecords<'_>, seed: u64) -> Self {
        let arm = records.arm;
        let successes = records.successes();
        let wilson = successes.wilson();
        let survival = Survival::new(&records.lifetimes());
        let iqm = records.iqm_env_steps(seed);
        let compacted = records.compacted_rules();
        let always = records.driven_always();
        let count =
            |is: &dyn Fn(&Figures) -> bool| records.figures().filter(|one| is(one)).count() as u64;
        Self {
            world: arm.world.clone(),
            method: arm.method_name().to_owned(),
            arena: arm.arena.name(),
            sensor: arm.sensor.name(),
            variant: arm.variant.to_string(),
            trials: successes.trials,
            failed: records.failed,
            successes: successes.successes,
            wilson_low: rounded(wilson.low),
            wilson_high: rounded(wilson.high),
            median_episode: survival.time_when_left(0.5),
            p95_episode: survival.time_when_left(0.05),
            median_episode_of_successes: quantile(&records.first_episodes(), 0.5),
            retained: records.retained(),
            mean_optimal_share_after_first: records.mean_share_after_first(),
            executed_optimal: count(&|one| one.progress.first_executed_optimal_episode.is_some()),
            iqm_env_steps: iqm.map(|iqm| rounded(iqm.value)),
            iqm_env_steps_low: iqm.map(|iqm| rounded(iqm.low)),
            iqm_env_steps_high: iqm.map(|iqm| rounded(iqm.high)),
            mean_steps: records.mean(|one| one.progress.steps as f64),
            mean_collisions: records.mean(|one| one.progress.collisions as f64),
            observation_error_share: records.share_of_steps(|one| one.observation_error),
            mislocalised_share: records.share_of_steps(|one| one.mislocalised),
            mean_rules: records.mean(|one| one.rules as f64),
            mean_greedy_steps: records.mean_of(|one| one.greedy_steps),
            most_greedy_steps: records.greedy_steps().reduce(f64::max).map(rounded),
            mean_greedy_ratio: records.mean_of(|one| one.greedy_ratio),
            driven_goals: records.mean_of(|one| one.driven.map(|d| d.share(d.goals))),
            driven_always: always.map(|always| always.successes),
            driven_always_low: always.map(|always| rounded(always.wilson().low)),
            driven_always_high: always.map(|always| rounded(always.wilson().high)),
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

/// To six decimals.
pub fn rounded(number: f64) -> f64 {
    (number * 1e6).round() / 1e6
}
