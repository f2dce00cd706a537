//! General rules about collisions, learned from a bump or two.
//!
//! A table must bump into every wall of every cell. The percept shows the walls, so one rule per
//! direction can foretell them all; but which bits are the wall's is not told. At the first bump
//! of an action, every condition of at most two alleles that matches the percept becomes a
//! candidate. Later bumps favour those that foretold them, moves drop those that were wrong, and
//! the candidates vote. The conditions are those of XCS, and so are the fitness-like weights; the
//! rules say nothing of a maze, only of the percept, so they hold in the next maze, too.

use serde::{Deserialize, Serialize};

use std::collections::BTreeMap;

use crate::signal::{Action, MAX_ACTIONS, Percept};
use crate::xcs::Condition;

/// Percepts wider than this get candidates of one allele only; there would be too many of two.
const WIDEST_FOR_PAIRS: usize = 64;
/// A candidate is dropped when fewer of its forecasts than this came true.
const LEAST_ACCURACY: f64 = 0.9;
/// The power with which weight grows with the share of bumps that were foretold.
const EMPHASIS: i32 = 8;

/// A rule that foretells a collision.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Candidate {
    pub condition: Condition,
    /// Percepts that it matches in which the action bumped ...
    hits: u32,
    /// ... and in which it moved.
    misses: u32,
}

/// What is known of one action.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
struct Bumps {
    /// In each percept, how often the action bumped and moved.
    evidence: BTreeMap<Percept, [u32; 2]>,
    candidates: Vec<Candidate>,
}

/// The rules for all actions.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct CollisionRules {
    actions: [Bumps; MAX_ACTIONS],
}

impl CollisionRules {
    /// Learns that an action bumped or moved; true if that may change a forecast.
    pub fn learn(&mut self, percept: &Percept, action: Action, bumped: bool) -> bool {
        let bumps = &mut self.actions[action.index()];
        let counts = bumps.evidence.entry(*percept).or_default();
        let before = verdict(counts);
        counts[usize::from(!bumped)] += 1;
        let after = verdict(counts);
        if after != before {
            bumps.score(percept);
        }
        after != before
    }

    /// How likely an action bumps in a percept, 0 to 1, by the vote of the candidates.
    pub fn forecast(&self, percept: &Percept, action: Action) -> f64 {
        let bumps = &self.actions[action.index()];
        let best = bumps.candidates.iter().map(|c| c.hits).max().unwrap_or(1);
        let weight = |c: &Candidate| (f64::from(c.hits) / f64::from(best)).powi(EMPHASIS);
        let all: f64 = bumps.candidates.iter().map(weight).sum();
        let matching = bumps
            .candidates
            .iter()
            .filter(|c| c.condition.matches(percept));
        if all > 0.0 {
            matching.map(weight).sum::<f64>() / all
        } else {
            0.0
        }
    }
}

/// Does a percept count as one where the action bumps? `None` where nothing is known.
fn verdict([bumped, moved]: &[u32; 2]) -> Option<bool> {
    (bumped + moved > 0).then_some(bumped > moved)
}

impl Bumps {
    /// Scores the candidates after the verdict on a percept has changed.
    fn score(&mut self, changed: &Percept) {
        let bumped = self.evidence.get(changed).and_then(verdict) == Some(true);
        let foretold = |c: &Candidate| c.condition.matches(changed);
        if bumped && !self.candidates.iter().any(foretold) {
            let new = conditions(changed);
            self.candidates.extend(new.map(|condition| Candidate {
                condition,
                hits: 0,
                misses: 0,
            }));
        }
        for candidate in &mut self.candidates {
            (candidate.hits, candidate.misses) = (0, 0);
            for (percept, counts) in &self.evidence {
                if candidate.condition.matches(percept) {
                    match verdict(counts) {
                        Some(true) => candidate.hits += 1,
                        Some(false) => candidate.misses += 1,
                        None => {}
                    }
                }
            }
        }
        self.candidates.retain(|c| {
            f64::from(c.hits) >= LEAST_ACCURACY * f64::from(c.hits + c.misses) && c.hits > 0
        });
    }
}

/// All conditions of one or two alleles that match a percept.
fn conditions(percept: &Percept) -> impl Iterator<Item = Condition> {
    let width = percept.width();
    let second = move |first| {
        if width > WIDEST_FOR_PAIRS {
            first..first + 1
        } else {
            first..width
        }
    };
    let pairs = (0..width).flat_map(move |first| second(first).map(move |second| [first, second]));
    let percept = *percept;
    pairs.map(move |alleles| Condition::of_alleles(&percept, alleles))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn learn(rules: &mut CollisionRules, percept: &str, bumped: bool) {
        rules.learn(&percept.parse().unwrap(), Action::new(0).unwrap(), bumped);
    }

    fn forecast(rules: &CollisionRules, percept: &str) -> f64 {
        rules.forecast(&percept.parse().unwrap(), Action::new(0).unwrap())
    }

    #[test]
    fn before_the_first_bump_nothing_is_foretold() {
        let mut rules = CollisionRules::default();
        learn(&mut rules, "0110", false);
        assert_eq!(forecast(&rules, "0110"), 0.0);
        assert_eq!(forecast(&rules, "1001"), 0.0);
    }

    #[test]
    fn a_few_bumps_and_moves_find_the_bits_that_matter() {
        // The wall shows as 01 in the first two bits; 11 there is the goal.
        let mut rules = CollisionRules::default();
        for (percept, bumped) in [
            ("01011000", true),
            ("00011000", false),
            ("01100101", true),
            ("11010101", false),
            ("00100111", false),
            ("01000010", true),
            ("10101010", false),
        ] {
            learn(&mut rules, percept, bumped);
        }
        for (percept, expected) in [("01111111", 1.0), ("00111000", 0.0), ("11100101", 0.0)] {
            let forecast = forecast(&rules, percept);
            assert!((forecast - expected).abs() < 0.3, "{percept}: {forecast}");
        }
        assert!(
            !rules
                .forecast(&"01".parse().unwrap(), Action::new(1).unwrap())
                .is_nan()
        );
    }

    #[test]
    fn a_false_bump_is_outvoted_by_later_moves() {
        let mut rules = CollisionRules::default();
        learn(&mut rules, "0011", true);
        assert_eq!(forecast(&rules, "0011"), 1.0);
        learn(&mut rules, "0011", false);
        learn(&mut rules, "0011", false);
        assert_eq!(forecast(&rules, "0011"), 0.0);
    }
}
