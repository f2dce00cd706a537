//! General rules about collisions, learned from a bump or two.
//!
//! A table must bump into every wall of every cell. But the percept shows the walls, so one rule per
//! direction can predict all bumps. Which bits show the wall is learned. At the first bump of an action,
//! every condition of at most two alleles that matches the percept becomes a candidate. Later bumps
//! favour the candidates that predicted them, moves drop the wrong ones, and the candidates vote.
//! Conditions and fitness-like weights are those of XCS; that a rule predicts the outcome of an action is an idea of
//! ACS2 (Butz 2002). The rules depend only on the percept, so they
//! also hold in the next maze.
//!
//! A bump to the north may also be informative about the east. This requires that the first bits of the
//! percept are a ring around the robot and that actions are directions. Then a rule for one action may
//! hold for every other one after a rotation (rotational symmetry). Such rules compete with those of each
//! action. Where they do not hold, moves soon refute them.

use crate::agent::model::CollisionRule;
use crate::agent::model::collision_candidates::CollisionCandidates;
use crate::agent::model::power::power;
use crate::agent::model::tally::Tally;
use xcs::{Action, ByAction, Layout, Percept};

/// A collision predicted with more certainty than this counts as certain. Far from the goal, even a small
/// doubt would give it a higher optimistic value than all known actions.
const CERTAIN: f64 = 0.5;

/// The exponent of a forecast, which is a share of votes. At 1, undecided votes cause detours.
const CERTAINTY: u32 = 32;

/// The rules for all actions.
#[derive(Debug, Clone)]
pub(in crate::agent) struct CollisionRules {
    count: usize,
    /// The number of bits of the percept that form a ring around the robot; 0 if none do.
    ring: usize,
    /// The layout of percepts. A rule requires exact values of numbers.
    layout: Layout,
    /// Rules for single actions.
    actions: ByAction<CollisionCandidates>,
    /// Rules for every action, on the percept rotated by the angle between the action and the first one.
    rotated: CollisionCandidates,
}

impl CollisionRules {
    /// Creates an untrained rule set for `actions` actions. The first `ring` bits of percepts form a
    /// ring.
    pub fn new(actions: usize, ring: usize, layout: Layout) -> Self {
        Self {
            count: actions,
            ring,
            layout,
            actions: Default::default(),
            rotated: CollisionCandidates::default(),
        }
    }

    /// Adds rules from another world; those for every action only if percepts are rotated here.
    pub fn warm_start(&mut self, rules: &[CollisionRule]) {
        for rule in rules {
            let candidates = match rule.action {
                Some(action) => &mut self.actions[action.index()],
                None if self.ring > 0 => &mut self.rotated,
                None => continue,
            };
            let (hits, misses) = (rule.hits, rule.misses);
            candidates.warm_start(rule.condition, Tally { hits, misses });
        }
    }

    /// Learns that an action bumped or moved. Returns true if a forecast may change.
    pub fn learn(&mut self, percept: &Percept, action: Action, bumped: bool) -> bool {
        let own = self.actions[action.index()].learn(percept, bumped, &self.layout);
        let rotated = self.rotate(percept, action);
        self.ring > 0 && self.rotated.learn(&rotated, bumped, &self.layout) || own
    }

    /// Sets the required lead of bumps or moves in a percept. If moves slip, one try is weak evidence.
    pub fn set_margin(&mut self, margin: u32) {
        let all = self.actions.iter_mut().chain([&mut self.rotated]);
        all.for_each(|candidates| candidates.set_margin(margin, &self.layout));
    }

    /// Returns the certainty that an action bumps in a percept, from 0 to 1.
    pub fn belief(&self, percept: &Percept, action: Action) -> f64 {
        let bump = power(self.forecast(percept, action), CERTAINTY);
        if bump > CERTAIN { 1.0 } else { bump }
    }

    /// Returns the probability that an action bumps in a percept, by the vote of the candidates.
    fn forecast(&self, percept: &Percept, action: Action) -> f64 {
        let own = &self.actions[action.index()];
        let best = own.most_hits().max(self.rotated.most_hits());
        let [own_bump, own_all] = own.votes(percept, best);
        let [rotated_bump, rotated_all] = self.rotated.votes(&self.rotate(percept, action), best);
        match best {
            0 => 0.0,
            _ => (own_bump + rotated_bump) / (own_all + rotated_all),
        }
    }

    /// Returns a number that changes with the forecasts.
    pub fn version(&self) -> u64 {
        let own: u64 = self.actions.iter().map(CollisionCandidates::version).sum();
        1 + own + self.rotated.version()
    }

    /// Returns the influential rules: those with at least half of the most hits of their kind.
    pub fn rules(&self) -> Vec<CollisionRule> {
        let own =
            Action::all(self.count).map(|action| (Some(action), &self.actions[action.index()]));
        let with_say = |(action, all): (Option<Action>, &CollisionCandidates)| {
            let least = all.most_hits().max(self.rotated.most_hits()).div_ceil(2);
            let rule = |condition, Tally { hits, misses }| CollisionRule {
                condition,
                action,
                hits,
                misses,
            };
            let strong = all.candidates().iter().filter(|c| c.tally.hits >= least);
            strong
                .map(|c| rule(c.condition, c.tally))
                .collect::<Vec<_>>()
        };
        [(None, &self.rotated)]
            .into_iter()
            .chain(own)
            .flat_map(with_say)
            .collect()
    }

    /// Rotates the percept into the frame of a robot that faces the direction of the action.
    fn rotate(&self, percept: &Percept, action: Action) -> Percept {
        percept.rotated(action.index() * self.ring / self.count, self.ring)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rules() -> CollisionRules {
        CollisionRules::new(4, 8, Layout::default())
    }

    fn action(number: usize) -> Action {
        Action::new(number).unwrap()
    }

    fn learn(rules: &mut CollisionRules, percept: &str, bumped: bool) {
        rules.learn(&percept.parse().unwrap(), action(0), bumped);
    }

    fn forecast(rules: &CollisionRules, percept: &str, of: usize) -> f64 {
        rules.forecast(&percept.parse().unwrap(), action(of))
    }

    #[test]
    fn before_the_first_bump_nothing_is_predicted() {
        let mut rules = rules();
        learn(&mut rules, "0110", false);
        assert_eq!(forecast(&rules, "0110", 0), 0.0);
        assert_eq!(forecast(&rules, "1001", 0), 0.0);
    }

    /// The first two bits are 01 for the wall, and 11 for the goal.
    const SEEN: [(&str, bool); 7] = [
        ("01011000", true),
        ("00011000", false),
        ("01100101", true),
        ("11010101", false),
        ("00100111", false),
        ("01000010", true),
        ("10101010", false),
    ];

    #[test]
    fn a_few_bumps_and_moves_find_the_bits_that_matter() {
        let mut rules = rules();
        SEEN.iter()
            .for_each(|(percept, bumped)| learn(&mut rules, percept, *bumped));
        for (percept, expected) in [("01111111", 1.0), ("00111000", 0.0), ("11100101", 0.0)] {
            let forecast = forecast(&rules, percept, 0);
            assert!((forecast - expected).abs() < 0.3, "{percept}: {forecast}");
        }
    }

    #[test]
    fn rules_of_one_action_hold_for_another_after_rotation_until_moves_refute_them() {
        let mut rules = rules();
        SEEN.iter()
            .for_each(|(percept, bumped)| learn(&mut rules, percept, *bumped));
        // Action 1 points two bits further.
        assert!(forecast(&rules, "00010000", 1) > 0.7);
        assert!(forecast(&rules, "01000000", 1) < 0.3);
        for moved in ["00010000", "10010110", "11011101", "00011111"] {
            rules.learn(&moved.parse().unwrap(), action(1), false);
        }
        assert!(forecast(&rules, "00010000", 1) < 0.3);
        assert!(forecast(&rules, "01111111", 0) > 0.7, "its own rules stay");
    }

    #[test]
    fn a_false_bump_is_outvoted_by_later_moves() {
        let mut rules = rules();
        learn(&mut rules, "0011", true);
        assert_eq!(forecast(&rules, "0011", 0), 1.0);
        learn(&mut rules, "0011", false);
        learn(&mut rules, "0011", false);
        assert_eq!(forecast(&rules, "0011", 0), 0.0);
    }

    #[test]
    fn rules_of_every_action_are_not_transferred_if_percepts_are_not_rotated() {
        let mut first = rules();
        SEEN.iter()
            .for_each(|(percept, bumped)| learn(&mut first, percept, *bumped));
        let mut next = CollisionRules::new(4, 0, Layout::default());
        next.warm_start(&first.rules());
        assert!(
            forecast(&next, "01010000", 0) > 0.7,
            "its own rules are transferred"
        );
        assert_eq!(forecast(&next, "00010000", 1), 0.0);
    }

    #[test]
    fn transferred_rules_predict_at_once() {
        let mut first = rules();
        SEEN.iter()
            .for_each(|(percept, bumped)| learn(&mut first, percept, *bumped));
        let mut next = rules();
        next.warm_start(&first.rules());
        for of in [0, 1] {
            let (there, here) = (
                forecast(&first, "01010000", of),
                forecast(&next, "01010000", of),
            );
            assert!(there > 0.7 && here > 0.7, "action {of}: {there}, {here}");
        }
    }
}
