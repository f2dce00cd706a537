//! The foresight of `xcscr-plus` for its rivals: what actions do that were never tried.

use crate::agent::model::bumps::Bumps;
use crate::agent::model::collision_rules::CollisionRules;
use crate::agent::model::known::Before;
use crate::agent::model::planner::Belief;
use crate::agent::model::return_rules::{Counts, ReturnRules};
use crate::agent::model::transitions::{Transition, Transitions};
use crate::agent::params::Params;
use xcs::{Action, ByAction, Percept};

/// What a file keeps of it.
pub(super) type Kept = ((ByAction<Bumps>, Bumps), Counts, Before);

/// Rules that foretell collisions and ways back, and what they are learned from.
#[derive(Debug, Clone)]
pub(super) struct Foretelling {
    collisions: CollisionRules,
    returns: ReturnRules,
    before: Before,
    /// The last move of this episode: from where, and by which action.
    last: Option<(Percept, Action)>,
}

impl Foretelling {
    /// Nothing is known of `actions` actions in percepts whose first `ring` bits form a ring.
    pub fn new(actions: usize, ring: usize, certainty: u32) -> Self {
        Self {
            collisions: CollisionRules::new(actions, ring, certainty),
            returns: ReturnRules::new(actions),
            before: Vec::new(),
            last: None,
        }
    }

    /// What learning has changed between two episodes.
    pub fn kept(&self) -> ((&ByAction<Bumps>, &Bumps), Counts, &Before) {
        (self.collisions.kept(), self.returns.kept(), &self.before)
    }

    /// Goes on from what was kept; `false` if it is not about `met` percepts, or there is no room in
    /// the counts.
    pub fn resume(&mut self, (collisions, returns, before): Kept, met: usize) -> bool {
        self.before = before;
        let mut pairs = self.before.iter().flatten();
        self.before.len() <= met
            && pairs.all(|pair| pair.0 < met)
            && self.collisions.resume(collisions)
            && self.returns.resume(returns)
    }

    /// Learns whether an action bumped.
    pub fn learn_bump(&mut self, percept: &Percept, action: Action, bumped: bool) {
        self.collisions.learn(percept, action, bumped);
    }

    /// Learns what a step led to, which is remembered; true if that may change what is foretold.
    pub fn learn(&mut self, memory: &mut Transitions, step: &Transition, bumped: bool) -> bool {
        let Transition {
            percept,
            action,
            next,
            ..
        } = *step;
        let mut news = false;
        if let Some((from, first)) = self.last.replace((percept, action))
            && from != percept
            && !bumped
        {
            news = self.returns.learn(first, action, next == Some(from));
        }
        let pair = (memory.meet(&percept), action);
        let next = next.map(|next| memory.meet(&next));
        self.before.resize(memory.percepts().len(), Vec::new());
        if let Some(next) = next
            && !self.before[next].contains(&pair)
        {
            self.before[next].push(pair);
            news = true;
        }
        news
    }

    /// The next step is the first of an episode.
    pub fn begin(&mut self) {
        self.last = None;
    }

    /// What is believed of an untried pair.
    pub fn belief(&self, memory: &Transitions, pair: (usize, Action), params: &Params) -> Belief {
        let (number, action) = pair;
        if let Some(back) = self.returns.way_back(memory, &self.before[number], pair) {
            return Belief::LeadsTo(params.step, back);
        }
        match self.collisions.belief(&memory.percepts()[number], action) {
            1.0 => Belief::LeadsTo(params.collision, number),
            bump => Belief::Bumps(bump),
        }
    }

    /// What is foretold of a percept's untried actions.
    pub fn foretold<'a>(
        &'a self,
        memory: &'a Transitions,
        number: usize,
        actions: usize,
        params: &'a Params,
    ) -> impl Iterator<Item = Transition> + 'a {
        let untried = move |&action: &Action| memory.outcomes(number, action).tries() == 0;
        let step = move |action| match self.belief(memory, (number, action), params) {
            Belief::Bumps(_) => None,
            Belief::LeadsTo(reward, to) => Some(Transition {
                percept: memory.percepts()[number],
                action,
                reward,
                next: Some(memory.percepts()[to]),
            }),
        };
        Action::all(actions).filter(untried).filter_map(step)
    }
}
