//! XCSAM: rules for the best actions only.
//!
//! XCS keeps rules for every action in every niche, including actions it never takes. XCSAM is
//! implemented after M. Nakata, P. L. Lanzi and K. Takadama, "XCS with adaptive action mapping"
//! (2012). Each rule has an `eam`, the number of actions that its niche needs. The eam falls toward
//! 1 while the rule's action is judged the best, and rises toward the number of actions otherwise.
//! Covering creates only as many actions as the mean eam of \[M\]. Rules of large eam are deleted
//! first.

use super::learner::Xcs;
use super::representation::Representation;
use super::sets::{ActionSet, MatchSet};
use crate::action::Action;

/// zeta: the fraction of the greatest value that a payoff must reach to count as the best.
const ZETA: f64 = 0.99;

impl<C: Representation> Xcs<C> {
    /// Enables the adaptive mapping.
    pub fn with_adaptive_mapping(mut self) -> Self {
        self.adapts = true;
        self
    }

    /// Returns the eam of a new rule: the number of actions, or 1 without an adaptive mapping.
    pub(super) fn eam_at_first(&self) -> f32 {
        if self.adapts {
            self.actions as f32
        } else {
            1.0
        }
    }

    /// Updates the eam of the rules of \[A\] at learning rate beta. The eam moves toward 1 if
    /// `payoff` shows that the action is one of the best in its percept, whose greatest value is
    /// `greatest`. Otherwise it moves toward the number of actions. Does nothing without an
    /// adaptive mapping.
    pub fn adapt_mapping(&mut self, set: &ActionSet<C>, payoff: f64, greatest: f64) {
        if !self.adapts {
            return;
        }
        let needs = if is_best(payoff, greatest) {
            1.0
        } else {
            self.actions as f64
        };
        let beta = self.params.beta;
        let moved = |eam: f64| (eam + beta * (needs - eam)) as f32;
        for &id in set.members() {
            self.population
                .modify(id, |rule| rule.eam = moved(rule.eam.into()));
        }
    }

    /// Covers a random action missing from \[M\] if \[M\] has fewer actions than its rules require.
    /// Returns `false` if \[M\] has enough.
    pub(super) fn cover_by_eam(&mut self, percept: &C::Percept, set: &MatchSet<C>) -> bool {
        let missing = Action::all(self.actions).filter(|&action| !set.covers(action));
        let missing: Vec<Action> = missing.collect();
        let held = self.actions - missing.len();
        if held as f64 >= self.required_actions(set) {
            return false;
        }
        let chosen = self.stream.choose(&missing).copied();
        chosen
            .inspect(|&action| self.cover(percept, action))
            .is_some()
    }

    /// Returns the mean eam of the micro-classifiers of \[M\]; the number of actions if \[M\] is
    /// empty.
    fn required_actions(&self, set: &MatchSet<C>) -> f64 {
        if set.is_empty() {
            return self.actions as f64;
        }
        let rules = set
            .members()
            .iter()
            .flat_map(|ids| self.population.living(ids));
        let eam: f64 = rules
            .map(|(_, rule)| f64::from(rule.eam) * f64::from(rule.numerosity))
            .sum();
        eam / f64::from(set.micro())
    }
}

/// Returns true if a payoff is within a fraction 1 - zeta of the greatest value.
///
/// For values above 0 this is the paper's `payoff >= zeta * greatest`. For values below 0, that
/// condition would require more than the greatest value, so the margin is subtracted instead.
fn is_best(payoff: f64, greatest: f64) -> bool {
    payoff >= greatest - (1.0 - ZETA) * greatest.abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;
    use crate::{Classifier, MatchSet, Params, Population};

    fn rule(condition: &str, action: usize, eam: f32) -> Classifier {
        let action = Action::new(action).unwrap();
        let condition = condition.parse().unwrap();
        Classifier {
            eam,
            ..Classifier::new(condition, action, 0, &Params::default())
        }
    }

    /// A learner for four actions that starts with some rules.
    fn learner(rules: &[Classifier]) -> Xcs {
        let rules = Population::try_from(rules.to_vec()).unwrap();
        Xcs::new(Params::default(), 4, Stream::new(1, 0_u64)).with_population(rules)
    }

    fn adaptive(rules: &[Classifier]) -> Xcs {
        learner(rules).with_adaptive_mapping()
    }

    /// Returns the eam of all rules after payoffs for action 0 in percept 0, whose greatest value
    /// is 100.
    fn eams_after(mut xcs: Xcs, payoffs: &[f64]) -> Vec<f32> {
        let set = xcs.matching_action_set(&"0".parse().unwrap(), Action::new(0).unwrap());
        for &payoff in payoffs {
            xcs.adapt_mapping(&set, payoff, 100.0);
        }
        xcs.population()
            .rules()
            .iter()
            .map(|rule| rule.eam)
            .collect()
    }

    /// Returns the actions that rules advocate in percept 0 once \[M\] is formed.
    fn actions_held(mut xcs: Xcs) -> Vec<usize> {
        let mut set = MatchSet::default();
        xcs.form_match_set(&"0".parse().unwrap(), &mut set);
        let held = Action::all(4).filter(|&action| set.covers(action));
        held.map(Action::index).collect()
    }

    #[test]
    fn eam_falls_toward_1_where_the_action_is_best() {
        let rules = [rule("0", 0, 4.0), rule("0", 1, 4.0)];
        // 4 + 0.2 (1 - 4) = 3.4; 3.4 + 0.2 (1 - 3.4) = 2.92. The rule of the other action gets no
        // payoff.
        assert_eq!(eams_after(adaptive(&rules), &[100.0]), [3.4, 4.0]);
        assert_eq!(eams_after(adaptive(&rules), &[100.0, 99.0]), [2.92, 4.0]);
        let end = eams_after(adaptive(&rules), &[100.0; 1000])[0];
        assert!((1.0..1.00001).contains(&end), "{end}");
    }

    #[test]
    fn eam_rises_toward_the_number_of_actions_where_it_is_not() {
        let rules = [rule("0", 0, 1.0)];
        // 1 + 0.2 (4 - 1) = 1.6; 1.6 + 0.2 (4 - 1.6) = 2.08.
        assert_eq!(eams_after(adaptive(&rules), &[98.9]), [1.6]);
        assert_eq!(eams_after(adaptive(&rules), &[98.9, -50.0]), [2.08]);
        let end = eams_after(adaptive(&rules), &[0.0; 1000])[0];
        assert!((3.9999..=4.0).contains(&end), "{end}");
    }

    #[test]
    fn without_an_adaptive_mapping_eam_stays() {
        assert_eq!(eams_after(learner(&[rule("0", 0, 1.0)]), &[0.0; 9]), [1.0]);
    }

    #[test]
    fn ties_are_best_on_either_side_of_zero() {
        let judged = |payoff, greatest| is_best(payoff, greatest);
        assert!(judged(99.0, 100.0) && !judged(98.9, 100.0));
        assert!(judged(0.0, 0.0) && !judged(-1.0, 0.0));
        assert!(judged(-100.0, -100.0) && judged(-101.0, -100.0) && !judged(-101.1, -100.0));
    }

    #[test]
    fn covering_creates_one_action_where_eam_is_1() {
        assert_eq!(actions_held(adaptive(&[rule("0", 2, 1.0)])), [2]);
        let all = actions_held(learner(&[rule("0", 2, 1.0)]));
        assert_eq!(all, [0, 1, 2, 3], "XCS covers them all");
    }

    #[test]
    fn covering_creates_the_mean_eam_of_micro_classifiers() {
        assert_eq!(actions_held(adaptive(&[])).len(), 4, "nothing is known");
        assert_eq!(actions_held(adaptive(&[rule("0", 2, 4.0)])).len(), 4);
        // (2 * 1 + 4) / 3 = 2 actions are required, and \[M\] has 2.
        let many = Classifier {
            numerosity: 2,
            ..rule("0", 2, 1.0)
        };
        assert_eq!(actions_held(adaptive(&[many, rule("#", 0, 4.0)])), [0, 2]);
        // (1 + 4) / 2 = 2.5 are required. With a third rule, of eam 4, (1 + 4 + 4) / 3 = 3.
        let two = [rule("0", 2, 1.0), rule("#", 0, 4.0)];
        assert_eq!(actions_held(adaptive(&two)).len(), 3);
    }

    #[test]
    fn rules_from_elsewhere_begin_with_the_eam_of_new_ones() {
        let brought = learner(&[rule("0", 2, 1.5)]);
        for (mut xcs, eam) in [(adaptive(&[]), 4.0), (learner(&[]), 1.0)] {
            xcs.start_from(brought.population());
            assert_eq!(xcs.population().rules()[0].eam, eam);
        }
    }
}
