//! The belief bound without slips: dynamic programming over sets of cells (LAO*; Hansen and
//! Zilberstein 2001). A cell is in a set as often as there are starts from which the robot would now
//! be there, so that the sets are beliefs.

use std::collections::{BTreeMap, BTreeSet};

use crate::agent::pomdp::{GOAL, Pomdp};
use xcs::Action;

/// States in ascending order, all of which look alike; one can come several times.
type Set = Vec<u32>;

/// Sets of cells that are weighed at most.
const MOST_WEIGHED: usize = 3_000_000;

/// Mean steps over the starts; `None` when there are too many sets to weigh.
pub fn steps(pomdp: &Pomdp, starts: &[u32], seen: &[f64]) -> Option<f64> {
    let firsts = split(pomdp, starts.to_vec());
    let mut search = Search {
        pomdp,
        seen,
        costs: BTreeMap::new(),
        weighed: 0,
    };
    loop {
        let mut visited = BTreeSet::new();
        let mut changed = false;
        for first in &firsts {
            changed |= search.improve(first, &mut visited)?;
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
    weighed: usize,
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
    /// one changed.
    fn improve(&mut self, set: &Set, visited: &mut BTreeSet<Set>) -> Option<bool> {
        if !visited.insert(set.clone()) {
            return Some(false);
        }
        self.weighed += 1;
        if self.weighed > MOST_WEIGHED || visited.len() > 20_000 {
            return None;
        }
        let (_, after) = self.best(set);
        let mut changed = false;
        for next in &after {
            changed |= self.improve(next, visited)?;
        }
        let (cost, _) = self.best(set);
        changed |= (cost - self.cost(set)).abs() > 1e-9;
        self.costs.insert(set.clone(), cost);
        Some(changed)
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
