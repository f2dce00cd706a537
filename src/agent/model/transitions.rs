//! Remembered transitions: what followed each pair of percept and action, and how often.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use xcs::random::Stream;
use xcs::{Action, ByAction, Percept};

/// One step, after it is known what came of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transition {
    pub percept: Percept,
    pub action: Action,
    pub reward: f64,
    /// What was perceived afterwards; `None` at a goal.
    pub next: Option<Percept>,
}

/// What followed a pair: the reward, the number of the next percept (`None` at a goal), and how
/// often that was seen.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    pub reward: f64,
    pub next: Option<usize>,
    pub count: u32,
}

/// Everything that followed one pair.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Outcomes(Vec<Outcome>);

/// The mean of `value` over outcomes, each by its frequency; 0 over none.
pub fn mean(outcomes: &[Outcome], value: impl Fn(&Outcome) -> f64) -> f64 {
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
        self.0.iter().map(|outcome| outcome.count).sum()
    }

    /// The mean of `value` over all outcomes, each by its frequency; 0 for an untried pair.
    pub fn mean(&self, value: impl Fn(&Outcome) -> f64) -> f64 {
        mean(&self.0, value)
    }

    /// Everything that followed, in the order in which it was first seen.
    pub fn all(&self) -> &[Outcome] {
        &self.0
    }

    /// The percept that always followed; `None` if there were several, or a goal, or none.
    pub fn only_next(&self) -> Option<usize> {
        match self.0[..] {
            [only] => only.next,
            _ => None,
        }
    }

    /// The percepts that followed.
    pub fn nexts(&self) -> impl Iterator<Item = usize> {
        self.0.iter().filter_map(|outcome| outcome.next)
    }

    /// Where the pair most often led from `percept`, and in which share of its tries; `None` when
    /// it stayed there, ended in a goal, or cost more than a `step`.
    pub fn likeliest_move(&self, percept: usize, step: f64) -> Option<(usize, f64)> {
        let likeliest = self.0.iter().rev().max_by_key(|o| o.count)?;
        let next = likeliest
            .next
            .filter(|&next| next != percept && likeliest.reward >= step)?;
        Some((next, f64::from(likeliest.count) / f64::from(self.tries())))
    }

    /// Do the counts leave room, and do the numbers name one of `met` percepts?
    fn is_sound(&self, met: usize) -> bool {
        let known = |o: &Outcome| {
            o.reward.is_finite() && o.next.is_none_or(|next| next < met) && o.count > 0
        };
        let tries: u64 = self.0.iter().map(|o| u64::from(o.count)).sum();
        self.0.iter().all(known) && tries <= u64::from(u32::MAX / 2)
    }

    /// Counts an outcome; true unless it is one more of what always happened.
    fn count(&mut self, reward: f64, next: Option<usize>) -> bool {
        let known = self
            .0
            .iter_mut()
            .find(|o| o.reward == reward && o.next == next);
        if let Some(outcome) = known {
            outcome.count += 1;
            return self.0.len() > 1;
        }
        self.0.push(Outcome {
            reward,
            next,
            count: 1,
        });
        true
    }

    /// One of the outcomes, each as likely as it was seen to be.
    fn draw(&self, stream: &mut Stream) -> Option<Outcome> {
        let mut left = stream.below(self.tries().max(1) as usize);
        let stops = |outcome: &&Outcome| {
            let found = left < outcome.count as usize;
            left = left.saturating_sub(outcome.count as usize);
            found
        };
        self.0.iter().find(stops).copied()
    }
}

/// All percepts that were met, numbered in the order of meeting, and what followed their pairs.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Transitions {
    numbers: BTreeMap<Percept, usize>,
    percepts: Vec<Percept>,
    pairs: Vec<ByAction<Outcomes>>,
    /// The pairs in the order in which they were first tried.
    tried: Vec<(usize, Action)>,
}

impl Transitions {
    /// The number of a percept, which is met now if it never was.
    pub fn meet(&mut self, percept: &Percept) -> usize {
        let next = self.percepts.len();
        let number = *self.numbers.entry(*percept).or_insert(next);
        if number == next {
            self.percepts.push(*percept);
            self.pairs.push(Default::default());
        }
        number
    }

    /// Do all numbers, in a memory that was read from a file, name what they should?
    pub fn is_sound(&self) -> bool {
        let met = self.percepts.len();
        let named =
            |(percept, &number): (&Percept, &usize)| self.percepts.get(number) == Some(percept);
        let tried = |&(percept, action): &(usize, Action)| {
            percept < met && self.outcomes(percept, action).tries() > 0
        };
        let mut outcomes = self.pairs.iter().flat_map(|pairs| pairs.iter());
        self.pairs.len() == met
            && self.numbers.len() == met
            && self.numbers.iter().all(named)
            && outcomes.all(|outcomes| outcomes.is_sound(met))
            && self.tried.iter().all(tried)
    }

    /// The percepts that were met in their own order, each with its number.
    pub fn sorted(&self) -> impl Iterator<Item = (&Percept, usize)> {
        self.numbers
            .iter()
            .map(|(percept, &number)| (percept, number))
    }

    /// The percepts that were met, by number.
    pub fn percepts(&self) -> &[Percept] {
        &self.percepts
    }

    /// What followed a pair.
    pub fn outcomes(&self, percept: usize, action: Action) -> &Outcomes {
        &self.pairs[percept][action.index()]
    }

    /// Remembers a transition; true if a plan over what is known may change, where a pair is
    /// known that was tried `known_after` times.
    pub fn learn(&mut self, step: &Transition, known_after: u32) -> bool {
        let met = self.percepts.len();
        let percept = self.meet(&step.percept);
        let next = step.next.map(|next| self.meet(&next));
        let outcomes = &mut self.pairs[percept][step.action.index()];
        let news = outcomes.count(step.reward, next);
        if outcomes.tries() == 1 {
            self.tried.push((percept, step.action));
        }
        news || outcomes.tries() <= known_after || self.percepts.len() > met
    }

    /// A remembered transition: any tried pair, each with the same chance, and one of its
    /// outcomes by frequency.
    pub fn recall(&self, stream: &mut Stream) -> Option<Transition> {
        let &(percept, action) = stream.choose(&self.tried)?;
        let Outcome { reward, next, .. } = self.outcomes(percept, action).draw(stream)?;
        Some(Transition {
            percept: self.percepts[percept],
            action,
            reward,
            next: next.map(|number| self.percepts[number]),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::streams::StreamName;

    fn step(from: &str, reward: f64, to: Option<&str>) -> Transition {
        Transition {
            percept: from.parse().unwrap(),
            action: Action::new(0).unwrap(),
            reward,
            next: to.map(|bits| bits.parse().unwrap()),
        }
    }

    #[test]
    fn outcomes_count_by_their_frequency() {
        let mut memory = Transitions::default();
        for reward in [-1.0, -1.0, -1.0, -50.0] {
            memory.learn(&step("00", reward, Some("01")), 1);
        }
        let outcomes = memory.outcomes(0, Action::new(0).unwrap());
        assert_eq!(outcomes.tries(), 4);
        assert_eq!(outcomes.mean(|o| o.reward), -13.25);
        let mut stream = Stream::new(1, StreamName::Replay);
        let bumps = (0..1000).filter(|_| memory.recall(&mut stream).unwrap().reward == -50.0);
        assert!((200..300).contains(&bumps.count()));
    }

    #[test]
    fn one_more_of_what_always_happened_is_no_news() {
        let mut memory = Transitions::default();
        assert!(memory.learn(&step("00", -1.0, Some("01")), 1));
        assert!(!memory.learn(&step("00", -1.0, Some("01")), 1));
        assert!(memory.learn(&step("00", -1.0, None), 1), "another outcome");
        assert!(memory.learn(&step("00", -1.0, None), 1), "the odds changed");
        assert!(
            memory.learn(&step("01", -1.0, None), 2) && memory.learn(&step("01", -1.0, None), 2)
        );
        assert!(
            !memory.learn(&step("01", -1.0, None), 2),
            "known after two tries"
        );
    }
}
