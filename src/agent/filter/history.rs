//! What was perceived and done, and in which places that must have been.

use std::collections::BTreeMap;
use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::agent::places::{Came, NEAR, Places, distance};
use crate::arena::Outcome;
use xcs::{Action, Percept};

/// A place in which the robot was at most so often may be none.
const RARE: u32 = 3;
/// What came of an action in less than one of so many tries may not have come of it.
const UNUSUAL: u64 = 3;
/// A percept that is seen after one action more often than this, beside what flips make expect and so many
/// deviations of that, is that of another place.
const AT_LEAST: f64 = 2.0;
const DEVIATIONS: f64 = 3.5;
/// Rounds through what is in doubt, at most.
const ROUNDS: usize = 6;
/// What more than half of the tries foretold, and did not come, is evidence for misread percepts if
/// it is seen so often, and in such a share of the steps.
const LEAST_EVIDENCE: usize = 3;
const LEAST_SHARE: f64 = 0.01;

/// What was felt of an action: an outcome without what is not learned from.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Felt {
    /// The robot moved on.
    Moved,
    /// It moved on, into a cell that paid this.
    Found(f64),
    /// It bumped into a wall.
    Bumped,
    /// It ran out of time on the way.
    Stalled,
    /// It reached a goal.
    Goal,
}

impl From<Outcome> for Felt {
    fn from(outcome: Outcome) -> Self {
        match outcome {
            Outcome::Moved => Self::Moved,
            Outcome::FoundReward { reward } => Self::Found(reward),
            Outcome::Collided { .. } => Self::Bumped,
            Outcome::Stalled => Self::Stalled,
            Outcome::ReachedGoal => Self::Goal,
        }
    }
}

impl From<Felt> for Outcome {
    fn from(felt: Felt) -> Self {
        match felt {
            Felt::Moved => Self::Moved,
            Felt::Found(reward) => Self::FoundReward { reward },
            Felt::Bumped => Self::Collided { impulse_ns: None },
            Felt::Stalled => Self::Stalled,
            Felt::Goal => Self::ReachedGoal,
        }
    }
}

/// A step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Step {
    pub seen: Percept,
    /// Where the robot was, as is believed now.
    pub place: usize,
    /// Is it the first of an episode?
    pub begins: bool,
    /// What was done then, and felt; `None` as long as it is not.
    pub done: Option<(Action, Felt)>,
}

impl Step {
    fn bump(&self) -> Option<Action> {
        self.done.filter(|it| it.1 == Felt::Bumped).map(|it| it.0)
    }
}

/// From where, and by which action, the robot came to a place.
type Entry = (Option<(usize, Action)>, usize);

/// Steps, and the places that are believed to explain them.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct History {
    pub steps: Vec<Step>,
    pub places: Places,
}

impl History {
    /// The robot perceives, in a place: where it was, if it has bumped.
    pub fn enter(&mut self, seen: &Percept, place: usize, begins: bool) -> usize {
        let last = self.steps.last().filter(|_| !begins).copied();
        let place = match last {
            Some(last) if last.bump().is_some() => last.place,
            _ => place,
        };
        self.places.visit(place, seen, true);
        match last.and_then(|last| Some((last.place, last.done?))) {
            None => self.places.begin(place, true),
            Some((_, (_, Felt::Bumped | Felt::Goal))) => {}
            Some((from, (action, _))) => {
                self.places.count(from, action, Came::To(place), true);
            }
        }
        self.steps.push(Step {
            seen: *seen,
            place,
            begins: last.is_none(),
            done: None,
        });
        place
    }

    /// It acts.
    pub fn act(&mut self, action: Action, felt: Felt) {
        let Some(step) = self.steps.last_mut() else {
            return;
        };
        step.done = Some((action, felt));
        match felt {
            Felt::Bumped => self.places.count(step.place, action, Came::Bumped, true),
            Felt::Goal => self.places.count(step.place, action, Came::Goal, true),
            _ => {}
        }
    }

    /// The steps that were taken in one place, because all but the last of them bumped.
    fn stay(&self, at: usize) -> Range<usize> {
        let mut begin = at;
        while begin > 0 && !self.steps[begin].begins && self.steps[begin - 1].bump().is_some() {
            begin -= 1;
        }
        let mut end = at + 1;
        while end < self.steps.len()
            && !self.steps[end].begins
            && self.steps[end - 1].bump().is_some()
        {
            end += 1;
        }
        begin..end
    }

    /// From where, and by which action, the robot came; `None` where an episode began.
    fn entrance(&self, begin: usize) -> Option<(usize, Action)> {
        let first = self.steps[begin];
        let before = self.steps[..begin].last().filter(|_| !first.begins)?;
        Some((before.place, before.done?.0))
    }

    /// By which action the robot left, and where that led; `None` where that is not known.
    fn exit(&self, end: usize) -> Option<(Action, Came)> {
        let (action, felt) = self.steps[end - 1].done?;
        match felt {
            Felt::Goal => Some((action, Came::Goal)),
            Felt::Bumped => None,
            _ => {
                let next = self.steps.get(end).filter(|next| !next.begins)?;
                Some((action, Came::To(next.place)))
            }
        }
    }

    /// Counts all that a stay tells, or takes it back.
    fn count(&mut self, stay: &Range<usize>, adds: bool) {
        let place = self.steps[stay.start].place;
        match self.entrance(stay.start) {
            None => self.places.begin(place, adds),
            Some((from, action)) => self.places.count(from, action, Came::To(place), adds),
        }
        for step in &self.steps[stay.clone()] {
            self.places.visit(place, &step.seen, adds);
            if let Some(action) = step.bump() {
                self.places.count(place, action, Came::Bumped, adds);
            }
        }
        if let Some((action, came)) = self.exit(stay.end) {
            self.places.count(place, action, came, adds);
        }
    }

    fn put(&mut self, stay: &Range<usize>, place: usize) {
        self.count(stay, false);
        let steps = &mut self.steps[stay.clone()];
        steps.iter_mut().for_each(|step| step.place = place);
        self.count(stay, true);
    }

    /// How well a place fits to a stay that is not counted.
    fn fit(&self, stay: &Range<usize>, place: usize) -> f64 {
        let places = &self.places;
        let mut fit = match self.entrance(stay.start) {
            None => places.chance_to_begin(Some(place)),
            Some((from, action)) => places.chance(Some(from), action, Some(Came::To(place))),
        };
        for step in &self.steps[stay.clone()] {
            fit *= places.look(place, &step.seen);
            if let Some(action) = step.bump() {
                fit *= places.chance(Some(place), action, Some(Came::Bumped));
            }
        }
        match self.exit(stay.end) {
            Some((action, came)) => fit * places.chance(Some(place), action, Some(came)),
            None => fit,
        }
    }

    /// Is it in doubt where a stay was?
    fn is_doubtful(&self, stay: &Range<usize>) -> bool {
        let place = self.steps[stay.start].place;
        if self.places.visits(place) <= RARE {
            return true;
        }
        let [count, all] = match self.entrance(stay.start) {
            None => self.places.begun(place),
            Some((from, action)) => {
                let tally = self.places.tally(from, action, Came::To(place));
                tally.map(u64::from)
            }
        };
        let leaves = self
            .exit(stay.end)
            .map(|(action, came)| self.places.tally(place, action, came).map(u64::from));
        let is_unusual = |[count, all]: [u64; 2]| UNUSUAL * count < all;
        is_unusual([count, all]) || leaves.is_some_and(is_unusual)
    }

    /// Is it in doubt where the robot is?
    pub fn is_in_doubt(&self) -> bool {
        let last = self.steps.len().saturating_sub(1);
        !self.steps.is_empty() && self.is_doubtful(&self.stay(last))
    }

    /// Decides anew where a stay was, by all others; true if that changes it.
    fn reconsider(&mut self, stay: &Range<usize>) -> bool {
        let old = self.steps[stay.start].place;
        self.count(stay, false);
        let seen = self.steps[stay.start].seen;
        let mut candidates: Vec<usize> = self.places.near(&seen).collect();
        match self.entrance(stay.start) {
            None => candidates.extend(self.places.beginnings()),
            Some((from, action)) => candidates.extend(self.places.successors(from, action)),
        }
        for at in stay.clone() {
            candidates.push(self.places.meet(&self.steps[at].seen));
        }
        candidates.sort_unstable();
        candidates.dedup();
        let (mut best, mut greatest) = (old, self.fit(stay, old));
        for place in candidates {
            let fit = self.fit(stay, place);
            if fit > greatest {
                (best, greatest) = (place, fit);
            }
        }
        let steps = &mut self.steps[stay.clone()];
        steps.iter_mut().for_each(|step| step.place = best);
        self.count(stay, true);
        best != old
    }

    /// Decides anew about all that is in doubt, until nothing changes; true if anything did. Each
    /// stay is decided by what all others tell, as in Gibbs sampling, but the likeliest place is taken
    /// (iterated conditional modes: Besag 1986).
    pub fn settle(&mut self) -> bool {
        let mut changed = false;
        for _ in 0..ROUNDS {
            let mut changes = self.part();
            let mut at = 0;
            while at < self.steps.len() {
                let stay = self.stay(at);
                if self.is_doubtful(&stay) {
                    changes |= self.reconsider(&stay);
                }
                at = stay.end;
            }
            changed |= changes;
            if !changes {
                break;
            }
        }
        changed
    }

    /// Parts places: what was seen too often to be misread is another place.
    fn part(&mut self) -> bool {
        let mut entries = BTreeMap::new();
        let mut others: BTreeMap<(Entry, Percept), Vec<usize>> = BTreeMap::new();
        for (at, step) in self.steps.iter().enumerate() {
            let entry = (self.entrance(at), step.place);
            *entries.entry(entry).or_insert(0_u32) += 1;
            if self.places.percept(step.place) != &step.seen && self.stay(at).len() == 1 {
                others.entry((entry, step.seen)).or_default().push(at);
            }
        }
        let mut changes = false;
        for ((entry, seen), steps) in others {
            let expected = f64::from(entries[&entry]) * self.places.look(entry.1, &seen);
            if steps.len() as f64 > AT_LEAST + expected + DEVIATIONS * expected.sqrt() {
                let other = self.places.meet(&seen);
                steps
                    .into_iter()
                    .for_each(|at| self.put(&(at..at + 1), other));
                changes = true;
            }
        }
        changes
    }

    /// Does the last step look nearly like where it would have been expected, and is elsewhere?
    pub fn is_odd(&self) -> bool {
        let Some(last) = self.steps.last() else {
            return false;
        };
        let at = self.steps.len() - 1;
        if self.stay(at).len() > 1 {
            return self.places.percept(last.place) != &last.seen;
        }
        self.entrance(at).is_some_and(|(from, action)| {
            let others = self.places.successors(from, action);
            let mut others = others.filter(|&other| other != last.place);
            others.any(|other| distance(self.places.percept(other), &last.seen) <= NEAR)
        })
    }

    /// Forgets places in which the robot never was, as is believed now; with no room for the others,
    /// also those in which it hardly ever was.
    pub fn tidy(&mut self, most: usize) {
        let rarely = match self.places.len() > most && self.steps.is_empty() {
            true => RARE,
            false => 0,
        };
        let numbers = self.places.forget(rarely);
        for step in &mut self.steps {
            step.place = numbers[step.place].unwrap_or_default();
        }
    }

    /// Is there evidence that percepts are misread: of what was felt, or of what went on as if the robot
    /// had been where it was expected? Moves that slip give none.
    pub fn tells_of_misreading(&mut self) -> bool {
        let (mut evidence, mut at) = (0, 0);
        while at < self.steps.len() {
            let stay = self.stay(at);
            evidence += usize::from(self.is_evidence(&stay));
            at = stay.end;
        }
        evidence >= LEAST_EVIDENCE && evidence as f64 >= LEAST_SHARE * self.steps.len() as f64
    }

    fn is_evidence(&mut self, stay: &Range<usize>) -> bool {
        let Step { place, seen, .. } = self.steps[stay.start];
        if stay.len() > 1 {
            let mut seen = self.steps[stay.clone()].iter().map(|step| &step.seen);
            return seen.any(|seen| seen != self.places.percept(place));
        }
        self.count(stay, false);
        let expected = self.entrance(stay.start).and_then(|(from, action)| {
            let never = self.places.tally(from, action, Came::To(place))[0] == 0;
            self.places.usual(from, action).filter(|_| never)
        });
        let goes_on =
            expected
                .zip(self.exit(stay.end))
                .is_some_and(|(expected, (action, came))| {
                    let there = self.places.tally(expected, action, came);
                    distance(self.places.percept(expected), &seen) <= NEAR
                        && 2 * there[0] > there[1]
                        && self.places.tally(place, action, came)[0] == 0
                });
        self.count(stay, true);
        goes_on
    }

    /// Is the history of one that knows so many actions?
    pub fn is_sound(&self, actions: usize) -> bool {
        let width = self.steps.first().map(|step| step.seen.width());
        let is_sound = |step: &Step| {
            step.place < self.places.len()
                && Some(step.seen.width()) == width
                && step.done.is_none_or(|(action, felt)| {
                    action.index() < actions
                        && !matches!(felt, Felt::Found(reward) if !reward.is_finite())
                })
        };
        self.places.is_sound(width, actions) && self.steps.iter().all(is_sound)
    }
}
