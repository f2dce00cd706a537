//! A transition model: counts what followed each pair of percept and action.

use std::collections::BTreeMap;

use crate::agent::model::outcomes::{Leads, Outcomes, Successor, mean};
use crate::agent::model::slips::{Evidence, Slips};
use xcs::random::Stream;
use xcs::{Action, ByAction, MAX_ACTIONS, Percept};

/// A step with its reward.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Experience {
    pub percept: Percept,
    pub action: Action,
    pub reward: f64,
    /// The next percept; `None` at a goal.
    pub next: Option<Percept>,
}

/// All percepts, numbered in order of their first appearance, and the outcomes of their pairs.
#[derive(Debug, Clone, Default)]
pub struct Transitions {
    numbers: BTreeMap<Percept, usize>,
    percepts: Vec<Percept>,
    pairs: Vec<ByAction<Outcomes>>,
    /// The pairs in the order of their first try.
    tried: Vec<(usize, Action)>,
    slips: Slips,
}

impl Transitions {
    /// Returns the number of a percept. Adds the percept if it is new.
    pub fn meet(&mut self, percept: &Percept) -> usize {
        let next = self.percepts.len();
        let number = *self.numbers.entry(*percept).or_insert(next);
        if number == next {
            self.percepts.push(*percept);
            self.pairs.push(Default::default());
        }
        number
    }

    /// Returns the number of a percept; `None` if it never appeared.
    pub fn number_of(&self, percept: &Percept) -> Option<usize> {
        self.numbers.get(percept).copied()
    }

    /// Returns the known percepts in sorted order, each with its number.
    pub fn sorted(&self) -> impl Iterator<Item = (&Percept, usize)> {
        self.numbers
            .iter()
            .map(|(percept, &number)| (percept, number))
    }

    /// Returns the known percepts by number.
    pub fn percepts(&self) -> &[Percept] {
        &self.percepts
    }

    /// Returns the outcomes of a pair.
    pub fn outcomes(&self, percept: usize, action: Action) -> &Outcomes {
        &self.pairs[percept][action.index()]
    }

    /// Returns the last estimate of how often moves slip.
    pub fn slips(&self) -> Slips {
        self.slips
    }

    /// Estimates the share of moves that slip from all pairs. A collision costs more than a `step`.
    fn estimated_slips(&self, step: f64) -> Slips {
        let mut evidence = Evidence::default();
        for &(percept, action) in &self.tried {
            self.outcomes(percept, action)
                .add_evidence(percept, step, &mut evidence);
        }
        evidence.slips()
    }

    /// Updates the slip estimate; returns true if it changed. A collision costs more than a `step`.
    pub fn update_slips(&mut self, step: f64) -> bool {
        let slips = self.estimated_slips(step);
        let is_news = !slips.is_like(self.slips);
        if is_news {
            self.slips = slips;
            let all = self.pairs.iter_mut().flat_map(|pairs| pairs.iter_mut());
            all.for_each(|outcomes| outcomes.leads_to = outcomes.believed(slips));
        }
        is_news
    }

    /// Returns true if the effect of a pair is known: after one try if no moves slip.
    pub fn is_known(&self, percept: usize, action: Action) -> bool {
        let outcomes = self.outcomes(percept, action);
        match self.slips.any() {
            true => outcomes.leads_to != Leads::Unknown,
            false => outcomes.tries() > 0,
        }
    }

    /// Returns the percept to which a pair leads unless it slips. If no moves slip, this is the percept
    /// that always followed. Returns `None` if there is none, or for a goal.
    pub fn next(&self, percept: usize, action: Action) -> Option<usize> {
        let outcomes = self.outcomes(percept, action);
        match outcomes.leads_to {
            Leads::To(next) => next,
            _ if self.slips.any() => None,
            _ => outcomes.only_next(),
        }
    }

    /// Returns true if slips explain the outcomes of a percept's actions. Otherwise several cells share
    /// it.
    pub fn is_explained(&self, percept: usize) -> bool {
        let mut pairs = self.pairs[percept].iter();
        pairs.all(|outcomes| outcomes.leads_to != Leads::Elsewhere)
    }

    /// Returns true if the estimated effect of a pair may be caused by several slips in a row. This is
    /// possible if the pair stays in place although a move is `predicted`, or if another action leads to
    /// the same percept. It is ruled out once the pair has twice the required lead.
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

    /// Returns true if the transition of a pair to `next` was a slip.
    pub fn slipped(&self, percept: usize, action: Action, next: usize) -> bool {
        self.slips.any() && self.next(percept, action) != Some(next)
    }

    /// Returns the mean of `value` over the outcomes of a pair, without slips.
    pub fn mean(&self, percept: usize, action: Action, value: impl Fn(&Successor) -> f64) -> f64 {
        let outcomes = self.outcomes(percept, action);
        match outcomes.leads_to {
            Leads::To(next) => mean(outcomes.all().iter().filter(|o| o.next == next), value),
            _ => outcomes.mean(value),
        }
    }

    /// Adds a transition. Returns true if plans on the known part of the model may change. A pair is
    /// known after `known_after` tries.
    pub fn learn(&mut self, step: &Experience, known_after: u32) -> bool {
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

    /// Draws a transition: a uniformly random tried pair, and one of its outcomes by frequency.
    pub fn recall(&self, stream: &mut Stream) -> Option<Experience> {
        let &(percept, action) = stream.choose(&self.tried)?;
        let Successor { reward, next, .. } = self.outcomes(percept, action).draw(stream)?;
        Some(Experience {
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

    fn step(from: &str, reward: f64, to: Option<&str>) -> Experience {
        Experience {
            percept: from.parse().unwrap(),
            action: Action::new(0).unwrap(),
            reward,
            next: to.map(|bits| bits.parse().unwrap()),
        }
    }

    #[test]
    fn outcomes_count_by_their_frequency() {
        let mut model = Transitions::default();
        for reward in [-1.0, -1.0, -1.0, -50.0] {
            model.learn(&step("00", reward, Some("01")), 1);
        }
        let outcomes = model.outcomes(0, Action::new(0).unwrap());
        assert_eq!(outcomes.tries(), 4);
        assert_eq!(outcomes.mean(|o| o.reward), -13.25);
        let mut stream = Stream::new(1, StreamName::Replay);
        let bumps = (0..1000).filter(|_| model.recall(&mut stream).unwrap().reward == -50.0);
        assert!((200..300).contains(&bumps.count()));
    }

    /// A corridor of three percepts, traversed in both directions `rounds` times. With `slips`, every
    /// third move slips and bumps.
    fn corridor(rounds: usize, slips: bool) -> Transitions {
        let mut model = Transitions::default();
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
            model.learn(
                &Experience {
                    percept,
                    action,
                    reward,
                    next,
                },
                1,
            );
            here = there;
        }
        model
    }

    #[test]
    fn if_moves_slip_a_pair_is_known_by_its_most_frequent_outcome() {
        let east = Action::new(1).unwrap();
        let mut model = corridor(12, true);
        let bumped = model.outcomes(0, east).all().len();
        assert!(bumped > 1, "control: some of its moves slipped");
        assert_eq!(model.next(0, east), None, "before slips are noticed");
        assert!(model.update_slips(-1.0));
        let next = model.next(0, east).map(|next| model.percepts()[next]);
        assert_eq!(next, Some(Percept::from_word(1, 2)));
        assert!(!model.update_slips(-1.0), "no more news");
    }

    #[test]
    fn control_if_no_move_slips_none_is_noticed_and_one_try_makes_a_pair_known() {
        let mut model = corridor(12, false);
        assert!(!model.update_slips(-1.0));
        assert!(model.is_known(0, Action::new(1).unwrap()));
    }

    #[test]
    fn repeating_the_only_outcome_changes_nothing() {
        let mut model = Transitions::default();
        assert!(model.learn(&step("00", -1.0, Some("01")), 1));
        assert!(!model.learn(&step("00", -1.0, Some("01")), 1));
        assert!(model.learn(&step("00", -1.0, None), 1), "another outcome");
        assert!(model.learn(&step("00", -1.0, None), 1), "the odds changed");
        assert!(model.learn(&step("01", -1.0, None), 2) && model.learn(&step("01", -1.0, None), 2));
        assert!(
            !model.learn(&step("01", -1.0, None), 2),
            "known after two tries"
        );
    }
}
