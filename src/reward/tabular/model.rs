//! A counted model of the environment: what followed each pair, and how often.

use std::collections::BTreeMap;

use super::table::Transition;
use crate::random::Stream;
use crate::signal::{Action, Percept};

/// What followed one pair.
#[derive(Debug, Clone, Default)]
pub(super) struct Outcomes {
    /// The reward and the next percept, and how often they were seen.
    seen: Vec<(f64, Option<Percept>, u32)>,
}

impl Outcomes {
    /// How often the pair was tried.
    pub fn tries(&self) -> u32 {
        self.seen.iter().map(|(.., count)| count).sum()
    }

    /// The mean over all outcomes of what `value` makes of reward and next percept.
    pub fn mean(&self, value: impl Fn(f64, Option<&Percept>) -> f64) -> f64 {
        let sum: f64 = self
            .seen
            .iter()
            .map(|(reward, next, count)| f64::from(*count) * value(*reward, next.as_ref()))
            .sum();
        sum / f64::from(self.tries().max(1))
    }

    fn count(&mut self, reward: f64, next: Option<Percept>) {
        let known = self
            .seen
            .iter_mut()
            .find(|(r, n, _)| *r == reward && *n == next);
        match known {
            Some((.., count)) => *count += 1,
            None => self.seen.push((reward, next, 1)),
        }
    }

    /// One of the outcomes, each as likely as it was seen to be.
    fn draw(&self, stream: &mut Stream) -> Option<(f64, Option<Percept>)> {
        let mut left = stream.below(self.tries().max(1) as usize) as u32;
        let stops = |(.., count): &&(f64, Option<Percept>, u32)| {
            let found = left < *count;
            left = left.saturating_sub(*count);
            found
        };
        self.seen
            .iter()
            .find(stops)
            .map(|&(reward, next, _)| (reward, next))
    }
}

/// Everything that was seen, by pair.
#[derive(Debug, Clone, Default)]
pub(super) struct Model {
    pairs: BTreeMap<(Percept, Action), Outcomes>,
    /// The pairs in the order in which they were first tried.
    order: Vec<(Percept, Action)>,
}

impl Model {
    /// Counts a transition; true if that changed what is known of pairs
    /// that were tried `known_after` times.
    pub fn learn(&mut self, transition: &Transition, known_after: u32) -> bool {
        let pair = (transition.percept, transition.action);
        let outcomes = self.pairs.entry(pair).or_insert_with(|| {
            self.order.push(pair);
            Outcomes::default()
        });
        let certain = outcomes.seen.len() == 1;
        outcomes.count(transition.reward, transition.next);
        // One more of what always happened changes no mean, but it may make the pair known.
        !certain || outcomes.seen.len() > 1 || outcomes.tries() <= known_after
    }

    /// What followed a pair; `None` if it was never tried.
    pub fn outcomes(&self, percept: &Percept, action: Action) -> Option<&Outcomes> {
        self.pairs.get(&(*percept, action))
    }

    /// All pairs with what followed them.
    pub fn pairs(&self) -> impl Iterator<Item = (&(Percept, Action), &Outcomes)> {
        self.pairs.iter()
    }

    /// A remembered transition: any pair, each with the same chance, and one of its outcomes.
    pub fn recall(&self, stream: &mut Stream) -> Option<Transition> {
        let &(percept, action) = stream.choose(&self.order)?;
        let (reward, next) = self.outcomes(&percept, action)?.draw(stream)?;
        Some(Transition {
            percept,
            action,
            reward,
            next,
        })
    }
}
