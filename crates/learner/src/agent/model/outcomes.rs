//! The outcomes of a pair of percept and action, and their interpretation.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use crate::agent::model::slips::{Evidence, Slips};
use xcs::random::Stream;

/// An outcome of a pair: the reward, the number of the next percept (`None` at a goal), and its count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Successor {
    pub reward: f64,
    pub next: Option<usize>,
    pub count: u32,
}

/// The number of tries after which a pair counts as known.
const MANY: u32 = 20;

/// All outcomes of one pair.
#[derive(Debug, Clone, Default)]
pub struct Outcomes {
    all: Vec<Successor>,
    pub(super) leads_to: Leads,
}

/// Where a pair leads unless it slips; `Unknown` if no moves slip.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) enum Leads {
    #[default]
    Unknown,
    /// To a percept, or the goal.
    To(Option<usize>),
    /// To different percepts: several cells share the pair's percept.
    Elsewhere,
}

/// Returns the mean of `value` over outcomes, weighted by frequency; 0 for none.
pub fn mean<'a>(
    outcomes: impl IntoIterator<Item = &'a Successor>,
    value: impl Fn(&Successor) -> f64,
) -> f64 {
    let (mut sum, mut tries) = (0.0, 0);
    for outcome in outcomes {
        sum += f64::from(outcome.count) * value(outcome);
        tries += outcome.count;
    }
    sum / f64::from(tries.max(1))
}

impl Outcomes {
    /// Returns how often the pair was tried.
    pub fn tries(&self) -> u32 {
        self.all.iter().map(|outcome| outcome.count).sum()
    }

    /// Returns the mean of `value` over all outcomes, weighted by frequency; 0 for an untried pair.
    pub fn mean(&self, value: impl Fn(&Successor) -> f64) -> f64 {
        mean(&self.all, value)
    }

    /// Returns all outcomes in the order of their first appearance.
    pub fn all(&self) -> &[Successor] {
        &self.all
    }

    /// Returns the percept that always followed; `None` for several ones, a goal, or an untried pair.
    pub fn only_next(&self) -> Option<usize> {
        match self.all[..] {
            [only] => only.next,
            _ => None,
        }
    }

    /// Returns how often a percept or a goal followed.
    fn count_of(&self, next: Option<usize>) -> u32 {
        let same = self.all.iter().filter(|outcome| outcome.next == next);
        same.map(|outcome| outcome.count).sum()
    }

    /// Returns the most frequent next percept or goal, and its lead over the second one; `None` for an
    /// untried pair.
    pub(super) fn likeliest(&self) -> Option<(Option<usize>, u32)> {
        // Each count, and the first appearance of its result. A result may have many rewards.
        let mut counts: BTreeMap<Option<usize>, (u32, Reverse<usize>)> = BTreeMap::new();
        for (at, outcome) in self.all.iter().enumerate() {
            let (count, _) = counts.entry(outcome.next).or_insert((0, Reverse(at)));
            *count += outcome.count;
        }
        let (&likeliest, &(count, _)) = counts.iter().max_by_key(|&(_, key)| key)?;
        let others = counts.iter().filter(|&(&next, _)| next != likeliest);
        let most = others.map(|(_, &(count, _))| count).max().unwrap_or(0);
        Some((likeliest, count - most))
    }

    /// Returns where the pair leads unless it slips: the most frequent result, if its lead is large
    /// enough or if there were many tries.
    pub(super) fn believed(&self, slips: Slips) -> Leads {
        if !slips.any() {
            return Leads::Unknown;
        }
        let Some((likeliest, lead)) = self.likeliest() else {
            return Leads::Unknown;
        };
        let tries = self.tries();
        match self.is_explained(slips) {
            false => Leads::Elsewhere,
            true if lead >= slips.lead() || tries >= MANY => Leads::To(likeliest),
            true => Leads::Unknown,
        }
    }

    /// Returns true if slips explain all outcomes other than the most frequent one.
    pub(super) fn is_explained(&self, slips: Slips) -> bool {
        let tries = self.tries();
        let likeliest = self.likeliest();
        likeliest.is_none_or(|(next, _)| slips.explain(tries - self.count_of(next), tries))
    }

    /// Adds this pair's evidence of slips. `percept` is the pair's percept. A collision costs more than a
    /// `step`.
    pub(super) fn add_evidence(&self, percept: usize, step: f64, evidence: &mut Evidence) {
        let bumps = |o: &&Successor| o.next == Some(percept) && o.reward < step;
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

    /// Returns the percepts that followed.
    pub fn nexts(&self) -> impl Iterator<Item = usize> {
        self.all.iter().filter_map(|outcome| outcome.next)
    }

    /// Returns the most frequent result of the pair and its share; `None` if it stayed in `percept`,
    /// ended in a goal, or cost more than a `step`.
    pub fn likeliest_move(&self, percept: usize, step: f64) -> Option<(usize, f64)> {
        let likeliest = self.all.iter().rev().max_by_key(|o| o.count)?;
        let next = likeliest
            .next
            .filter(|&next| next != percept && likeliest.reward >= step)?;
        Some((next, f64::from(likeliest.count) / f64::from(self.tries())))
    }

    /// Counts an outcome. Returns true if it is new or if there are several outcomes.
    pub(super) fn count(&mut self, reward: f64, next: Option<usize>) -> bool {
        let known = self
            .all
            .iter_mut()
            .find(|o| o.reward == reward && o.next == next);
        if let Some(outcome) = known {
            outcome.count += 1;
            return self.all.len() > 1;
        }
        self.all.push(Successor {
            reward,
            next,
            count: 1,
        });
        true
    }

    /// Draws an outcome by frequency.
    pub(super) fn draw(&self, stream: &mut Stream) -> Option<Successor> {
        let mut left = stream.below(self.tries().max(1) as usize);
        let stops = |outcome: &&Successor| {
            let found = left < outcome.count as usize;
            left = left.saturating_sub(outcome.count as usize);
            found
        };
        self.all.iter().find(stops).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The most frequent result and its lead, by counting each result anew.
    fn slowly(outcomes: &Outcomes) -> Option<(Option<usize>, u32)> {
        let counts = outcomes
            .all
            .iter()
            .map(|o| (o.next, outcomes.count_of(o.next)));
        let (likeliest, count) = counts.rev().max_by_key(|&(_, count)| count)?;
        let others = outcomes.all.iter().filter(|o| o.next != likeliest);
        let most = others.map(|o| outcomes.count_of(o.next)).max();
        Some((likeliest, count - most.unwrap_or(0)))
    }

    #[test]
    fn the_most_frequent_result_is_that_of_counting_all_and_of_equals_the_first() {
        let mut stream = Stream::new(3, 0_u64);
        let mut ties = 0;
        for _ in 0..2_000 {
            let mut outcomes = Outcomes::default();
            for _ in 0..stream.below(12) {
                let next = Some(stream.below(4)).filter(|&next| next > 0);
                outcomes.count(stream.below(3) as f64, next);
            }
            let found = outcomes.likeliest();
            assert_eq!(found, slowly(&outcomes), "{outcomes:?}");
            ties += usize::from(found.is_some_and(|(_, lead)| lead == 0));
        }
        assert!(ties > 200, "control: {ties} ties");
    }
}
