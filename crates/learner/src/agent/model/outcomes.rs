//! Everything that followed a pair of percept and action, and what that means.

use serde::{Deserialize, Serialize};

use crate::agent::model::slips::{Evidence, Slips};
use xcs::random::Stream;

/// What followed a pair: the reward, the number of the next percept (`None` at a goal), and how
/// often that was seen.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    pub reward: f64,
    pub next: Option<usize>,
    pub count: u32,
}

/// A pair that was tried so often has nothing new to tell.
const MANY: u32 = 20;

/// Everything that followed one pair.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Outcomes {
    all: Vec<Outcome>,
    pub(super) leads_to: Leads,
}

/// Where a pair leads unless it slips; `Unknown` where no moves do.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) enum Leads {
    #[default]
    Unknown,
    /// To a percept, or the goal.
    To(Option<usize>),
    /// Here and there: its percept is that of several places.
    Elsewhere,
}

/// The mean of `value` over outcomes, each by its frequency; 0 over none.
pub fn mean<'a>(
    outcomes: impl IntoIterator<Item = &'a Outcome>,
    value: impl Fn(&Outcome) -> f64,
) -> f64 {
    let (mut sum, mut tries) = (0.0, 0);
    for outcome in outcomes {
        sum += f64::from(outcome.count) * value(outcome);
        tries += outcome.count;
    }
    sum / f64::from(tries.max(1))
}

impl Outcomes {
    /// How often the pair was tried.
    pub fn tries(&self) -> u32 {
        self.all.iter().map(|outcome| outcome.count).sum()
    }

    /// The mean of `value` over all outcomes, each by its frequency; 0 for an untried pair.
    pub fn mean(&self, value: impl Fn(&Outcome) -> f64) -> f64 {
        mean(&self.all, value)
    }

    /// Everything that followed, in the order in which it was first seen.
    pub fn all(&self) -> &[Outcome] {
        &self.all
    }

    /// The percept that always followed; `None` if there were several, or a goal, or none.
    pub fn only_next(&self) -> Option<usize> {
        match self.all[..] {
            [only] => only.next,
            _ => None,
        }
    }

    /// How often a percept followed, or a goal.
    fn count_of(&self, next: Option<usize>) -> u32 {
        let same = self.all.iter().filter(|outcome| outcome.next == next);
        same.map(|outcome| outcome.count).sum()
    }

    /// The percept that followed most often, or a goal, and by how much more often than any other;
    /// `None` if nothing followed.
    pub(super) fn likeliest(&self) -> Option<(Option<usize>, u32)> {
        let counts = self.all.iter().map(|o| (o.next, self.count_of(o.next)));
        let (likeliest, count) = counts.rev().max_by_key(|&(_, count)| count)?;
        let others = self.all.iter().filter(|o| o.next != likeliest);
        let most = others.map(|o| self.count_of(o.next)).max().unwrap_or(0);
        Some((likeliest, count - most))
    }

    /// The percept, or the goal, to which the pair leads unless it slips: what followed more often
    /// than anything else, by enough of a lead, or most often of many tries.
    pub(super) fn believed(&self, slips: Slips) -> Leads {
        let Some((likeliest, lead)) = self.likeliest().filter(|_| slips.any()) else {
            return Leads::Unknown;
        };
        let tries = self.tries();
        match self.is_explained(slips) {
            false => Leads::Elsewhere,
            true if lead >= slips.lead() || tries >= MANY => Leads::To(likeliest),
            true => Leads::Unknown,
        }
    }

    /// Do slips explain everything that followed but what followed most often?
    pub(super) fn is_explained(&self, slips: Slips) -> bool {
        let tries = self.tries();
        let likeliest = self.likeliest();
        likeliest.is_none_or(|(next, _)| slips.explain(tries - self.count_of(next), tries))
    }

    /// What the pair, of this percept, tells of slips; a collision costs more than a `step`.
    pub(super) fn tell(&self, percept: usize, step: f64, evidence: &mut Evidence) {
        let bumps = |o: &&Outcome| o.next == Some(percept) && o.reward < step;
        let bumped: u32 = self.all.iter().filter(bumps).map(|o| o.count).sum();
        let tries = self.tries();
        evidence.all += tries;
        evidence.mixed += bumped.min(tries - bumped);
        if let Some((next, _)) = self.likeliest()
            && next != Some(percept)
            && tries > 1
            && self.leads_to != Leads::Elsewhere
        {
            evidence.moves += tries;
            evidence.odd += tries - self.count_of(next);
        }
    }

    /// The percepts that followed.
    pub fn nexts(&self) -> impl Iterator<Item = usize> {
        self.all.iter().filter_map(|outcome| outcome.next)
    }

    /// Where the pair most often led from `percept`, and in which share of its tries; `None` when
    /// it stayed there, ended in a goal, or cost more than a `step`.
    pub fn likeliest_move(&self, percept: usize, step: f64) -> Option<(usize, f64)> {
        let likeliest = self.all.iter().rev().max_by_key(|o| o.count)?;
        let next = likeliest
            .next
            .filter(|&next| next != percept && likeliest.reward >= step)?;
        Some((next, f64::from(likeliest.count) / f64::from(self.tries())))
    }

    /// Do the counts leave room, and do the numbers name one of `met` percepts?
    pub(super) fn is_sound(&self, met: usize, slips: Slips) -> bool {
        let known = |o: &Outcome| {
            o.reward.is_finite() && o.next.is_none_or(|next| next < met) && o.count > 0
        };
        let tries: u64 = self.all.iter().map(|o| u64::from(o.count)).sum();
        self.all.iter().all(known)
            && self.leads_to == self.believed(slips)
            && tries <= u64::from(u32::MAX / 2)
    }

    /// Counts an outcome; true unless it is one more of what always happened.
    pub(super) fn count(&mut self, reward: f64, next: Option<usize>) -> bool {
        let known = self
            .all
            .iter_mut()
            .find(|o| o.reward == reward && o.next == next);
        if let Some(outcome) = known {
            outcome.count += 1;
            return self.all.len() > 1;
        }
        self.all.push(Outcome {
            reward,
            next,
            count: 1,
        });
        true
    }

    /// One of the outcomes, each as likely as it was seen to be.
    pub(super) fn draw(&self, stream: &mut Stream) -> Option<Outcome> {
        let mut left = stream.below(self.tries().max(1) as usize);
        let stops = |outcome: &&Outcome| {
            let found = left < outcome.count as usize;
            left = left.saturating_sub(outcome.count as usize);
            found
        };
        self.all.iter().find(stops).copied()
    }
}
