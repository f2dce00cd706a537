//! General rules about inverse actions, learned from a step or two.
//!
//! An example is "an action is undone by the one half a turn further". Whether such a rule holds, and for
//! which turn, is estimated from counts. Where it holds, the way back need not be tried in every cell.

use crate::agent::model::InverseActionRule;
use crate::agent::model::slips::Slips;
use crate::agent::model::tally::Tally;
use crate::agent::model::transitions::Transitions;
use xcs::{Action, ByAction};

/// A rule is used from this number of successes on ...
const LEAST_HITS: u32 = 2;
/// ... if they are at least this share of its trials.
const LEAST_ACCURACY: f64 = 0.9;

/// For each turn from one action to the next, how often it led back.
#[derive(Debug, Clone)]
pub(in crate::agent) struct InverseActionRules {
    actions: usize,
    /// By turn: how often it led back (hits), and how often elsewhere (misses).
    counts: ByAction<Tally>,
    /// The least share of successes of a rule that is used.
    least_accuracy: f64,
}

impl InverseActionRules {
    /// Creates an untrained rule set for `actions` actions.
    pub fn new(actions: usize) -> Self {
        Self {
            actions,
            counts: Default::default(),
            least_accuracy: LEAST_ACCURACY,
        }
    }

    /// Adds rules from another world.
    pub fn warm_start(&mut self, rules: &[InverseActionRule]) {
        for rule in rules {
            let (hits, misses) = (rule.hits, rule.misses);
            self.counts[rule.turn.index()] = Tally { hits, misses };
        }
    }

    /// Lowers the required accuracy to allow for slips on the way there and on the way back.
    pub fn allow(&mut self, slips: Slips) {
        self.least_accuracy = LEAST_ACCURACY * slips.intended() * slips.intended();
    }

    /// Learns whether `next`, executed right after a move by `first`, led back. Returns true if the set
    /// of rules in use changes.
    pub fn learn(&mut self, first: Action, next: Action, back: bool) -> bool {
        let turn = turn(first, next, self.actions);
        let before = self.is_used(self.counts[turn]);
        self.counts[turn].add(Some(back));
        self.is_used(self.counts[turn]) != before
    }

    /// Returns true if `next` is predicted to undo a move by `first`.
    pub fn undoes(&self, first: Action, next: Action) -> bool {
        self.is_used(self.counts[turn(first, next, self.actions)])
    }

    /// Returns the percept to which an action is predicted to lead back. `before` holds the pairs that
    /// led to the current percept.
    pub fn predicted_return(
        &self,
        model: &Transitions,
        before: &[(usize, Action)],
        (percept, action): (usize, Action),
    ) -> Option<usize> {
        let mut before = before.iter().rev();
        let leads_back = |&&(from, there): &&(usize, Action)| {
            from != percept
                && self.undoes(there, action)
                && model.next(from, there) == Some(percept)
        };
        before.find(leads_back).map(|&(from, _)| from)
    }

    /// Returns the rules in use.
    pub fn rules(&self) -> impl Iterator<Item = InverseActionRule> {
        let turns = Action::all(self.actions).zip(self.counts.iter());
        let used = turns.filter(|&(_, &count)| self.is_used(count));
        used.map(|(turn, &Tally { hits, misses })| InverseActionRule { turn, hits, misses })
    }

    fn is_used(&self, Tally { hits, misses }: Tally) -> bool {
        hits >= LEAST_HITS && f64::from(hits) >= self.least_accuracy * f64::from(hits + misses)
    }
}

/// Returns the turn from one of `actions` actions to the next.
fn turn(first: Action, next: Action, actions: usize) -> usize {
    (next.index() + actions - first.index()) % actions
}

#[cfg(test)]
mod tests {
    use super::*;

    fn undoing(rules: &InverseActionRules, first: usize) -> Vec<usize> {
        let first = Action::new(first).unwrap();
        let undoing = Action::all(4).filter(|&next| rules.undoes(first, next));
        undoing.map(Action::index).collect()
    }

    fn learn(rules: &mut InverseActionRules, [first, next]: [usize; 2], back: bool) {
        let [first, next] = [first, next].map(|number| Action::new(number).unwrap());
        rules.learn(first, next, back);
    }

    #[test]
    fn going_back_twice_in_any_direction_is_enough_to_use_the_rule() {
        let mut rules = InverseActionRules::new(4);
        learn(&mut rules, [0, 2], true);
        assert!(undoing(&rules, 0).is_empty());
        learn(&mut rules, [3, 1], true);
        assert_eq!(
            [0, 1, 2, 3].map(|first| undoing(&rules, first)),
            [[2], [3], [0], [1]]
        );
    }

    #[test]
    fn a_turn_that_often_leads_elsewhere_is_not_used() {
        let mut rules = InverseActionRules::new(4);
        for back in [true, true, false, true] {
            learn(&mut rules, [0, 2], back);
        }
        assert!(undoing(&rules, 0).is_empty());
        (0..10).for_each(|_| learn(&mut rules, [0, 2], true));
        assert_eq!(undoing(&rules, 0), [2]);
    }
}
