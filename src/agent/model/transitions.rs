//! Remembered transitions: what followed each pair of percept and action, and how often.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::slips::{Evidence, Slips};
use xcs::random::Stream;
use xcs::{Action, ByAction, MAX_ACTIONS, Percept};

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

/// A pair that was tried so often has nothing new to tell.
const MANY: u32 = 20;

/// Everything that followed one pair.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Outcomes {
    all: Vec<Outcome>,
    /// Where moves slip: the percept, or the goal, to which the pair is known to lead otherwise.
    leads_to: Option<Option<usize>>,
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
    fn likeliest(&self) -> Option<(Option<usize>, u32)> {
        let counts = self.all.iter().map(|o| (o.next, self.count_of(o.next)));
        let (likeliest, count) = counts.rev().max_by_key(|&(_, count)| count)?;
        let others = self.all.iter().filter(|o| o.next != likeliest);
        let most = others.map(|o| self.count_of(o.next)).max().unwrap_or(0);
        Some((likeliest, count - most))
    }

    /// The percept, or the goal, to which the pair leads unless it slips: what followed more often
    /// than anything else, by enough of a lead, or most often of many tries.
    fn believed(&self, slips: Slips) -> Option<Option<usize>> {
        let (likeliest, lead) = self.likeliest().filter(|_| slips.any())?;
        let is_believed = lead >= slips.lead() || self.tries() >= MANY;
        is_believed.then_some(likeliest)
    }

    /// What the pair, of this percept, tells of slips; a collision costs more than a `step`.
    fn tell(&self, percept: usize, step: f64, evidence: &mut Evidence) {
        let bumps = |o: &&Outcome| o.next == Some(percept) && o.reward < step;
        let bumped: u32 = self.all.iter().filter(bumps).map(|o| o.count).sum();
        let tries = self.tries();
        evidence.all += tries;
        evidence.mixed += bumped.min(tries - bumped);
        if let Some((next, _)) = self.likeliest()
            && next != Some(percept)
            && tries > 1
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
    fn is_sound(&self, met: usize, slips: Slips) -> bool {
        let known = |o: &Outcome| {
            o.reward.is_finite() && o.next.is_none_or(|next| next < met) && o.count > 0
        };
        let tries: u64 = self.all.iter().map(|o| u64::from(o.count)).sum();
        self.all.iter().all(known)
            && self.leads_to == self.believed(slips)
            && tries <= u64::from(u32::MAX / 2)
    }

    /// Counts an outcome; true unless it is one more of what always happened.
    fn count(&mut self, reward: f64, next: Option<usize>) -> bool {
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
    fn draw(&self, stream: &mut Stream) -> Option<Outcome> {
        let mut left = stream.below(self.tries().max(1) as usize);
        let stops = |outcome: &&Outcome| {
            let found = left < outcome.count as usize;
            left = left.saturating_sub(outcome.count as usize);
            found
        };
        self.all.iter().find(stops).copied()
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
    slips: Slips,
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
        self.slips.is_sound()
            && self.pairs.len() == met
            && self.numbers.len() == met
            && self.numbers.iter().all(named)
            && outcomes.all(|outcomes| outcomes.is_sound(met, self.slips))
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

    /// How often moves slip, by the last estimate.
    pub fn slips(&self) -> Slips {
        self.slips
    }

    /// Estimates how often moves slip; true if that is news. A collision costs more than a `step`.
    pub fn notice_slips(&mut self, step: f64) -> bool {
        let mut evidence = Evidence::default();
        for &(percept, action) in &self.tried {
            self.outcomes(percept, action)
                .tell(percept, step, &mut evidence);
        }
        let slips = evidence.slips();
        let is_news = !slips.is_like(self.slips);
        if is_news {
            self.slips = slips;
            let all = self.pairs.iter_mut().flat_map(|pairs| pairs.iter_mut());
            all.for_each(|outcomes| outcomes.leads_to = outcomes.believed(slips));
        }
        is_news
    }

    /// Is it known what a pair does? Where no moves slip, it is after one try.
    pub fn is_known(&self, percept: usize, action: Action) -> bool {
        let outcomes = self.outcomes(percept, action);
        match self.slips.any() {
            true => outcomes.leads_to.is_some(),
            false => outcomes.tries() > 0,
        }
    }

    /// The percept to which a pair is known to lead, unless it slips; where no moves slip, the one
    /// that always followed. `None` if there is none, or a goal.
    pub fn next(&self, percept: usize, action: Action) -> Option<usize> {
        let outcomes = self.outcomes(percept, action);
        match self.slips.any() {
            true => outcomes.leads_to?,
            false => outcomes.only_next(),
        }
    }

    /// May what is known of a pair be some slips in a row? So it may if it stays where it is although a
    /// move is `foretold`, or leads where another action leads, too; not once it has twice the lead that
    /// is asked for.
    pub fn is_doubtful(&self, percept: usize, action: Action, foretold: bool) -> bool {
        let outcomes = self.outcomes(percept, action);
        let Some(next) = outcomes.leads_to else {
            return false;
        };
        let lead = outcomes.likeliest().map_or(0, |(_, lead)| lead);
        let mut others = Action::all(MAX_ACTIONS).filter(|&other| other != action);
        lead < 2 * self.slips.lead()
            && match next == Some(percept) {
                true => foretold,
                false => others.any(|other| self.outcomes(percept, other).leads_to == Some(next)),
            }
    }

    /// Was it a slip that `next` followed a pair?
    pub fn slipped(&self, percept: usize, action: Action, next: usize) -> bool {
        self.slips.any() && self.next(percept, action) != Some(next)
    }

    /// The mean of `value` over what followed a pair, without slips.
    pub fn mean(&self, percept: usize, action: Action, value: impl Fn(&Outcome) -> f64) -> f64 {
        let outcomes = self.outcomes(percept, action);
        match outcomes.leads_to {
            Some(next) => mean(outcomes.all.iter().filter(|o| o.next == next), value),
            None => outcomes.mean(value),
        }
    }

    /// Remembers a transition; true if a plan over what is known may change, where a pair is
    /// known that was tried `known_after` times.
    pub fn learn(&mut self, step: &Transition, known_after: u32) -> bool {
        let met = self.percepts.len();
        let percept = self.meet(&step.percept);
        let next = step.next.map(|next| self.meet(&next));
        let outcomes = &mut self.pairs[percept][step.action.index()];
        let news = outcomes.count(step.reward, next);
        outcomes.leads_to = outcomes.believed(self.slips);
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

    /// A corridor of three percepts, walked to and fro `rounds` times; every third move slips, and one
    /// that slips bumps.
    fn corridor(rounds: usize, slips: bool) -> Transitions {
        let mut memory = Transitions::default();
        let mut here = 0_usize;
        for count in 0..8 * rounds {
            let east = count / 4 % 2 == 0;
            let slip = slips && count % 3 == 2;
            let there = match (slip, east) {
                (true, _) => here,
                (false, true) => (here + 1).min(2),
                (false, false) => here.saturating_sub(1),
            };
            let percept = |number: usize| Percept::from_word(number as u64, 2);
            let action = Action::new(usize::from(east)).unwrap();
            let reward = if there == here { -50.0 } else { -1.0 };
            let (percept, next) = (percept(here), Some(percept(there)));
            memory.learn(
                &Transition {
                    percept,
                    action,
                    reward,
                    next,
                },
                1,
            );
            here = there;
        }
        memory
    }

    #[test]
    fn where_moves_slip_a_pair_is_known_by_what_mostly_comes_of_it() {
        let east = Action::new(1).unwrap();
        let mut memory = corridor(12, true);
        let bumped = memory.outcomes(0, east).all().len();
        assert!(bumped > 1, "control: some of its moves slipped");
        assert_eq!(memory.next(0, east), None, "before slips are noticed");
        assert!(memory.notice_slips(-1.0));
        let next = memory.next(0, east).map(|next| memory.percepts()[next]);
        assert_eq!(next, Some(Percept::from_word(1, 2)));
        assert!(!memory.notice_slips(-1.0), "no more news");
        assert!(memory.is_sound());
    }

    #[test]
    fn control_where_no_move_slips_none_is_noticed_and_one_try_makes_a_pair_known() {
        let mut memory = corridor(12, false);
        assert!(!memory.notice_slips(-1.0));
        assert!(memory.is_known(0, Action::new(1).unwrap()));
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
