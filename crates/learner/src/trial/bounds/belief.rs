//! The belief bound without slips: dynamic programming over sets of cells (LAO*; Hansen and
//! Zilberstein 2001). A cell is in a set as often as there are starts from which the robot would now
//! be there, so that the sets are beliefs.

use std::collections::{BTreeMap, BTreeSet};

use crate::agent::pomdp::{GOAL, Pomdp};
use xcs::Action;

/// States in ascending order, all of which look alike; one can come several times.
type Set = Vec<u32>;

/// The most work: states that are moved by one action each, in all sets that are weighed. Beyond, it
/// would take more than a moment.
const MOST_MOVES: usize = 10_000_000;
/// The most states in the sets whose costs are kept.
const MOST_KEPT: usize = 2_000_000;

/// Mean steps over the starts; `None` when there are too many sets to weigh.
pub fn steps(pomdp: &Pomdp, starts: &[u32], seen: &[f64]) -> Option<f64> {
    let firsts = split(pomdp, starts.to_vec());
    let mut search = Search {
        pomdp,
        seen,
        costs: BTreeMap::new(),
        moves: 0,
        kept: 0,
    };
    loop {
        let mut visited = BTreeSet::new();
        let mut changed = false;
        for first in &firsts {
            if !visited.contains(first) {
                changed |= search.improve(first, &mut visited)?;
            }
        }
        if !changed {
            break;
        }
    }
    let total = firsts
        .iter()
        .map(|first| search.cost(first) * first.len() as f64);
    Some(total.sum::<f64>() / starts.len() as f64)
}

/// Groups states by how they look.
fn split(pomdp: &Pomdp, mut states: Set) -> Vec<Set> {
    states.sort_unstable_by_key(|&state| (pomdp.look(state), state));
    let alike = states.chunk_by(|&a, &b| pomdp.look(a) == pomdp.look(b));
    alike.map(<[u32]>::to_vec).collect()
}

struct Search<'a> {
    pomdp: &'a Pomdp,
    /// By state: what it costs when it is seen, which is never more than what it costs.
    seen: &'a [f64],
    costs: BTreeMap<Set, f64>,
    moves: usize,
    kept: usize,
}

impl Search<'_> {
    /// Mean steps from the states of a set, as far as it is known, and never too many.
    fn cost(&self, set: &Set) -> f64 {
        self.costs.get(set).copied().unwrap_or_else(|| {
            let sum: f64 = set.iter().map(|&state| self.seen[state as usize]).sum();
            sum / set.len() as f64
        })
    }

    /// Improves the costs of all sets that the best actions lead to, the last ones first; true if
    /// one changed, `None` when it is too much work.
    fn improve(&mut self, first: &Set, visited: &mut BTreeSet<Set>) -> Option<bool> {
        let mut changed = false;
        // A list instead of recursion, which corridors would let grow beyond the stack. Each set
        // comes with those that follow it and are still to be improved before it.
        let mut open = vec![self.visit(first, visited)?];
        while let Some((_, after)) = open.last_mut() {
            if let Some(next) = after.pop() {
                if !visited.contains(&next) {
                    let next = self.visit(&next, visited)?;
                    open.push(next);
                }
            } else if let Some((set, _)) = open.pop() {
                changed |= self.settle(set);
            }
        }
        Some(changed)
    }

    /// Begins with a set: the sets that its best action leads to, the first of them last.
    fn visit(&mut self, set: &Set, visited: &mut BTreeSet<Set>) -> Option<(Set, Vec<Set>)> {
        visited.insert(set.clone());
        // It is weighed now, and once more when those after it are settled.
        self.moves += 2 * set.len() * self.pomdp.actions();
        if self.moves > MOST_MOVES || self.kept > MOST_KEPT {
            return None;
        }
        let (_, mut after) = self.best(set);
        after.reverse();
        Some((set.clone(), after))
    }

    /// Gives a set its cost; true if it had another one.
    fn settle(&mut self, set: Set) -> bool {
        let (cost, _) = self.best(&set);
        let changed = (cost - self.cost(&set)).abs() > 1e-9;
        let size = set.len();
        if self.costs.insert(set, cost).is_none() {
            self.kept += size;
        }
        changed
    }

    /// The least cost of an action, and the sets that it leads to.
    fn best(&self, set: &Set) -> (f64, Vec<Set>) {
        let after = |action: Action| {
            let next = set.iter().map(|&state| self.pomdp.next(state, action));
            next.filter(|&next| next != GOAL).collect::<Set>()
        };
        let weighed = Action::all(self.pomdp.actions()).map(|action| {
            let sets = split(self.pomdp, after(action));
            let sum: f64 = sets
                .iter()
                .map(|next| self.cost(next) * next.len() as f64)
                .sum();
            (1.0 + sum / set.len() as f64, sets)
        });
        let better = |best: (f64, Vec<Set>), one: (f64, Vec<Set>)| {
            if one.0 < best.0 - 1e-12 { one } else { best }
        };
        weighed.reduce(better).expect("there is an action")
    }
}
