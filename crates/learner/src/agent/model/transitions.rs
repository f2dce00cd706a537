//! Remembered transitions: what followed each pair of percept and action, and how often.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::agent::model::outcomes::{Leads, Outcome, Outcomes, mean};
use crate::agent::model::slips::{Evidence, Slips};
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

    /// The number of a percept; `None` if it was never met.
    pub fn number_of(&self, percept: &Percept) -> Option<usize> {
        self.numbers.get(percept).copied()
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

    /// The share of moves that slip, estimated from all pairs. A collision costs more than a `step`.
    fn estimated_slips(&self, step: f64) -> Slips {
        let mut evidence = Evidence::default();
        for &(percept, action) in &self.tried {
            self.outcomes(percept, action)
                .tell(percept, step, &mut evidence);
        }
        evidence.slips()
    }

    /// Where moves slip: did more come of some pair than slips explain? Then several cells share its percept.
    pub fn is_refuted(&self) -> bool {
        let mut tried = self.tried.iter();
        let unexplained = |&(percept, action): &(usize, Action)| {
            self.outcomes(percept, action).leads_to == Leads::Elsewhere
        };
        self.slips.any() && tried.any(unexplained)
    }

    /// Estimates how often moves slip; true if that is news. A collision costs more than a `step`.
    pub fn notice_slips(&mut self, step: f64) -> bool {
        let slips = self.estimated_slips(step);
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
            true => outcomes.leads_to != Leads::Unknown,
            false => outcomes.tries() > 0,
        }
    }

    /// The percept to which a pair is known to lead, unless it slips; where no moves slip, the one
    /// that always followed. `None` if there is none, or a goal.
    pub fn next(&self, percept: usize, action: Action) -> Option<usize> {
        let outcomes = self.outcomes(percept, action);
        match outcomes.leads_to {
            Leads::To(next) => next,
            _ if self.slips.any() => None,
            _ => outcomes.only_next(),
        }
    }

    /// Do slips explain what came of the actions of a percept? If not, several places look like it.
    pub fn is_explained(&self, percept: usize) -> bool {
        let mut pairs = self.pairs[percept].iter();
        pairs.all(|outcomes| outcomes.leads_to != Leads::Elsewhere)
    }

    /// May what is known of a pair be some slips in a row? So it may if it stays where it is although a
    /// move is `predicted`, or leads where another action leads, too; not once it has twice the lead that
    /// is asked for.
    pub fn is_doubtful(&self, percept: usize, action: Action, predicted: bool) -> bool {
        let outcomes = self.outcomes(percept, action);
        let Leads::To(next) = outcomes.leads_to else {
            return false;
        };
        let lead = outcomes.likeliest().map_or(0, |(_, lead)| lead);
        let mut others = Action::all(MAX_ACTIONS).filter(|&other| other != action);
        lead < 2 * self.slips.lead()
            && match next == Some(percept) {
                true => predicted,
                false => {
                    others.any(|other| self.outcomes(percept, other).leads_to == Leads::To(next))
                }
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
            Leads::To(next) => mean(outcomes.all().iter().filter(|o| o.next == next), value),
            _ => outcomes.mean(value),
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
    use xcscr_robot::streams::StreamName;

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
