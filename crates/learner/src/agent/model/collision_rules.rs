//! General rules about collisions, learned from a bump or two.
//!
//! A table must bump into every wall of every cell. The percept shows the walls, so one rule per
//! direction can foretell them all; but which bits are the wall's is not told. At the first bump
//! of an action, every condition of at most two alleles that matches the percept becomes a
//! candidate. Later bumps favour those that predicted them, moves drop those that were wrong, and
//! the candidates vote. The conditions are those of XCS, and so are the fitness-like weights; the
//! rules say nothing of a maze, only of the percept, so they hold in the next maze, too.
//!
//! A bump to the north may also tell about the east: if the first bits of the percept are a ring
//! around the robot, and the actions are directions, then a rule for one action may hold for every
//! other one, turned. Such rules stand for election beside those of each action; where they do not
//! hold, moves soon prove them wrong.

use crate::agent::model::CollisionRule;
use crate::agent::model::bumps::Bumps;
use crate::agent::model::tally::Tally;
use crate::agent::power;
use xcs::{Action, ByAction, Percept};

/// A collision that is predicted with more certainty than this is believed outright: far from the
/// goal, even a small doubt would promise more than all that is known.
const BELIEVED: f64 = 0.5;

/// The rules for all actions.
#[derive(Debug, Clone)]
pub(in crate::agent) struct CollisionRules {
    count: usize,
    /// The bits of the percept that lie in a ring around the robot; 0 if none do.
    ring: usize,
    /// The power to which a forecast is raised before it is believed.
    certainty: u32,
    /// Rules for one action each.
    actions: ByAction<Bumps>,
    /// Rules for every action, on the percept turned as far as the action is from the first one.
    turned: Bumps,
}

impl CollisionRules {
    /// Nothing is known of `actions` actions in percepts whose first `ring` bits form a ring.
    pub fn new(actions: usize, ring: usize, certainty: u32) -> Self {
        Self {
            count: actions,
            ring,
            certainty,
            actions: Default::default(),
            turned: Bumps::default(),
        }
    }

    /// Takes rules from another world; those of every action only if percepts are turned here.
    pub fn bring(&mut self, rules: &[CollisionRule]) {
        for rule in rules {
            let bumps = match rule.action {
                Some(action) => &mut self.actions[action.index()],
                None if self.ring > 0 => &mut self.turned,
                None => continue,
            };
            let (hits, misses) = (rule.hits, rule.misses);
            bumps.bring(rule.condition, Tally { hits, misses });
        }
    }

    /// What learning has changed so far.
    pub fn kept(&self) -> (&ByAction<Bumps>, &Bumps) {
        (&self.actions, &self.turned)
    }

    /// Goes on from what was kept; `false` if there is no room in the counts.
    pub fn resume(&mut self, (actions, turned): (ByAction<Bumps>, Bumps)) -> bool {
        (self.actions, self.turned) = (actions, turned);
        let mut all = self.actions.iter().chain([&self.turned]);
        all.all(Bumps::is_sound)
    }

    /// Learns that an action bumped or moved; true if that may change a forecast.
    pub fn learn(&mut self, percept: &Percept, action: Action, bumped: bool) -> bool {
        let own = self.actions[action.index()].learn(percept, bumped);
        let turned = self.turn(percept, action);
        self.ring > 0 && self.turned.learn(&turned, bumped) || own
    }

    /// Bumps or moves must be ahead by this margin in a percept to count: where moves slip, one try
    /// tells little.
    pub fn demand(&mut self, margin: u32) {
        let all = self.actions.iter_mut().chain([&mut self.turned]);
        all.for_each(|bumps| bumps.demand(margin));
    }

    /// How firmly it is believed that an action bumps in a percept, 0 to 1.
    pub fn belief(&self, percept: &Percept, action: Action) -> f64 {
        let bump = power(self.forecast(percept, action), self.certainty);
        if bump > BELIEVED { 1.0 } else { bump }
    }

    /// How likely an action bumps in a percept, 0 to 1, by the vote of the candidates.
    fn forecast(&self, percept: &Percept, action: Action) -> f64 {
        let own = &self.actions[action.index()];
        let best = own.most_hits().max(self.turned.most_hits());
        let [own_bump, own_all] = own.votes(percept, best);
        let [turned_bump, turned_all] = self.turned.votes(&self.turn(percept, action), best);
        match best {
            0 => 0.0,
            _ => (own_bump + turned_bump) / (own_all + turned_all),
        }
    }

    /// Another number after each change of a forecast.
    pub fn version(&self) -> u64 {
        let own: u64 = self.actions.iter().map(Bumps::version).sum();
        1 + own + self.turned.version()
    }

    /// The rules that have a say: those with at least half of the most hits of their kind.
    pub fn rules(&self) -> Vec<CollisionRule> {
        let own =
            Action::all(self.count).map(|action| (Some(action), &self.actions[action.index()]));
        let with_say = |(action, bumps): (Option<Action>, &Bumps)| {
            let least = bumps.most_hits().max(self.turned.most_hits()).div_ceil(2);
            let rule = |condition, Tally { hits, misses }| CollisionRule {
                condition,
                action,
                hits,
                misses,
            };
            let strong = bumps.candidates().iter().filter(|c| c.tally.hits >= least);
            strong
                .map(|c| rule(c.condition, c.tally))
                .collect::<Vec<_>>()
        };
        [(None, &self.turned)]
            .into_iter()
            .chain(own)
            .flat_map(with_say)
            .collect()
    }

    /// The percept as it looks to someone who faces the way of the action.
    fn turn(&self, percept: &Percept, action: Action) -> Percept {
        percept.turned(action.index() * self.ring / self.count, self.ring)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rules() -> CollisionRules {
        CollisionRules::new(4, 8, 1)
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
    fn before_the_first_bump_nothing_is_foretold() {
        let mut rules = rules();
        learn(&mut rules, "0110", false);
        assert_eq!(forecast(&rules, "0110", 0), 0.0);
        assert_eq!(forecast(&rules, "1001", 0), 0.0);
    }

    /// The wall shows as 01 in the first two bits; 11 there is the goal.
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
    fn bumps_of_one_action_tell_about_another_one_turned_until_moves_say_otherwise() {
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
    fn rules_of_every_action_stay_behind_where_percepts_are_not_turned() {
        let mut first = rules();
        SEEN.iter()
            .for_each(|(percept, bumped)| learn(&mut first, percept, *bumped));
        let mut next = CollisionRules::new(4, 0, 1);
        next.bring(&first.rules());
        assert!(forecast(&next, "01010000", 0) > 0.7, "its own rules come");
        assert_eq!(forecast(&next, "00010000", 1), 0.0);
    }

    #[test]
    fn rules_that_are_brought_along_foretell_at_once() {
        let mut first = rules();
        SEEN.iter()
            .for_each(|(percept, bumped)| learn(&mut first, percept, *bumped));
        let mut next = rules();
        next.bring(&first.rules());
        for of in [0, 1] {
            let (there, here) = (
                forecast(&first, "01010000", of),
                forecast(&next, "01010000", of),
            );
            assert!(there > 0.7 && here > 0.7, "action {of}: {there}, {here}");
        }
    }
}
