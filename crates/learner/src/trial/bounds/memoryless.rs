//! The memoryless optimum, the best policy with one action for each percept: branch and bound.

use std::collections::VecDeque;

use super::{Estimate, MOST_STEPS};
use crate::agent::model::pomdp::{GOAL, Pomdp};
use xcs::Action;

/// The maximum number of partial policies that are searched.
const MOST_POLICIES: usize = 100_000;
/// The maximum work, in states visited per action and evaluation. More would take noticeably long.
const MOST_LOOKS: usize = 1_000_000_000;

/// Returns the mean steps of the best policy over the starts, without slips. If there are too many
/// policies to search, `error` bounds how much better than the best one found an unsearched policy
/// may be.
pub fn steps(pomdp: &Pomdp, starts: &[u32]) -> Estimate {
    let mut search = Search {
        pomdp,
        starts,
        before: before(pomdp),
        least: f64::from(MOST_STEPS),
        left: MOST_POLICIES.min(MOST_LOOKS / per_policy(pomdp)),
        skipped: f64::from(MOST_STEPS),
    };
    search.branch(&mut vec![None; pomdp.looks()]);
    Estimate {
        steps: search.least,
        error: (search.least - search.skipped).max(0.0),
    }
}

/// The work for a partial policy, which is evaluated with every action and searched for conflicts.
fn per_policy(pomdp: &Pomdp) -> usize {
    let looks = pomdp.looks() + pomdp.actions() + 1;
    (pomdp.states() * pomdp.actions() * looks).max(1)
}

/// By state: the predecessor states and actions. The goal comes last.
fn before(pomdp: &Pomdp) -> Vec<Vec<(u32, Action)>> {
    let mut before = vec![Vec::new(); pomdp.states() + 1];
    for state in 0..pomdp.states() as u32 {
        for action in Action::all(pomdp.actions()) {
            let next = pomdp.next(state, action);
            let at = if next == GOAL {
                pomdp.states()
            } else {
                next as usize
            };
            before[at].push((state, action));
        }
    }
    before
}

struct Search<'a> {
    pomdp: &'a Pomdp,
    starts: &'a [u32],
    before: Vec<Vec<(u32, Action)>>,
    /// The mean steps of the best policy so far.
    least: f64,
    /// The number of partial policies that may still be searched.
    left: usize,
    /// A lower bound of the mean steps of all policies that were not searched.
    skipped: f64,
}

/// By percept: the action of a policy, if decided.
type Policy = Vec<Option<Action>>;

impl Search<'_> {
    /// Searches all completions of a policy, unless none can be the best.
    fn branch(&mut self, policy: &mut Policy) {
        let distances = self.distances(policy);
        let bound = self.mean(&distances);
        if bound >= self.least - 1e-9 {
            return;
        }
        if self.left == 0 {
            self.skipped = self.skipped.min(bound);
            return;
        }
        self.left -= 1;
        let Some(look) = self.conflict(policy, &distances) else {
            self.least = bound;
            return;
        };
        let mut ranked: Vec<(f64, Action)> = Action::all(self.pomdp.actions())
            .map(|action| {
                policy[look] = Some(action);
                (self.mean(&self.distances(policy)), action)
            })
            .collect();
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, action) in ranked {
            policy[look] = Some(action);
            self.branch(policy);
        }
        policy[look] = None;
    }

    /// Returns steps to the goal from each state if open decisions may differ between states;
    /// [`MOST_STEPS`] if there is no path.
    fn distances(&self, policy: &Policy) -> Vec<u32> {
        let mut distances = vec![MOST_STEPS; self.pomdp.states()];
        let mut queue = VecDeque::from([(self.pomdp.states(), 0)]);
        while let Some((to, steps)) = queue.pop_front() {
            for &(state, action) in &self.before[to] {
                let decided = policy[self.pomdp.look(state) as usize];
                let allowed = decided.is_none_or(|decided| decided == action);
                let distance = &mut distances[state as usize];
                if allowed && *distance == MOST_STEPS && steps + 1 < MOST_STEPS {
                    *distance = steps + 1;
                    queue.push_back((state as usize, steps + 1));
                }
            }
        }
        distances
    }

    fn mean(&self, distances: &[u32]) -> f64 {
        let steps = self
            .starts
            .iter()
            .map(|&start| f64::from(distances[start as usize]));
        steps.sum::<f64>() / self.starts.len() as f64
    }

    /// Returns the open percept with the most states among the percepts without an action that is
    /// best in all their states.
    fn conflict(&self, policy: &Policy, distances: &[u32]) -> Option<usize> {
        let states = 0..self.pomdp.states() as u32;
        let aliased = |look: usize| {
            let states = states.clone();
            states.filter(move |&state| self.pomdp.look(state) as usize == look)
        };
        let best = |state: u32, action: Action| {
            let here = distances[state as usize];
            let next = self.pomdp.next(state, action);
            let after = if next == GOAL {
                0
            } else {
                distances[next as usize]
            };
            here == MOST_STEPS || after + 1 == here
        };
        let agree = |look: usize| {
            let mut actions = Action::all(self.pomdp.actions());
            actions.any(|action| aliased(look).all(|state| best(state, action)))
        };
        let looks = (0..policy.len()).filter(|&look| policy[look].is_none());
        let open = looks.filter(|&look| aliased(look).nth(1).is_some() && !agree(look));
        open.max_by_key(|&look| aliased(look).count())
    }
}
