//! General rules that predict the effects of actions. They are exported and transferred between mazes.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use xcs::Action;
use xcs::Condition;

/// What `xcscr-plus` has learned about moving, independently of a maze.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Generalisation {
    /// The rules that predict collisions.
    pub collisions: Vec<CollisionRule>,
    /// The rules that predict which action undoes another.
    pub returns: Vec<InverseActionRule>,
}

/// The maximum count of a rule.
const MOST_COUNTED: u32 = 1_000_000_000;
/// The maximum number of collision rules. Every one of them is evaluated at every step.
const MOST_COLLISION_RULES: usize = 10_000;

impl Generalisation {
    /// Checks that the rules are distinct, apply to `actions` actions, and have valid counts.
    ///
    /// # Errors
    /// The first invalid rule.
    pub fn check(&self, actions: usize) -> Result<(), String> {
        let number = self.collisions.len();
        if number > MOST_COLLISION_RULES {
            return Err(format!(
                "there are {number} collision rules, but at most {MOST_COLLISION_RULES} are possible"
            ));
        }
        let mut seen = BTreeSet::new();
        self.collisions
            .iter()
            .try_for_each(|rule| rule.check(&mut seen))?;
        let mut seen = BTreeSet::new();
        self.returns
            .iter()
            .try_for_each(|rule| rule.check(actions, &mut seen))
    }
}

impl CollisionRule {
    fn check(&self, seen: &mut BTreeSet<(Condition, Option<Action>)>) -> Result<(), String> {
        let Self {
            condition,
            hits,
            misses,
            ..
        } = self;
        if !(1..=MOST_COUNTED).contains(hits) || *misses > MOST_COUNTED {
            return Err(format!(
                "the collision rule {condition} counts {hits} hits and {misses} misses: hits must be from 1 to {MOST_COUNTED}, misses from 0"
            ));
        }
        match seen.insert((*condition, self.action)) {
            true => Ok(()),
            false => Err(format!(
                "the collision rule {condition} is listed twice for the same action"
            )),
        }
    }
}

impl InverseActionRule {
    fn check(&self, actions: usize, seen: &mut BTreeSet<Action>) -> Result<(), String> {
        let Self { turn, hits, misses } = self;
        let number = turn.index();
        if number >= actions || hits.max(misses) > &MOST_COUNTED {
            return Err(format!(
                "the inverse-action rule of turn {number} counts {hits} hits and {misses} misses: there are {actions} actions, and at most {MOST_COUNTED} can be counted"
            ));
        }
        match seen.insert(*turn) {
            true => Ok(()),
            false => Err(format!(
                "the inverse-action rule of turn {number} is listed twice"
            )),
        }
    }
}

/// A rule that predicts a collision in percepts that match its condition.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CollisionRule {
    /// The condition on the percept.
    pub condition: Condition,
    /// The action to which the rule applies. `None`: every action. Then the bits in a ring around the
    /// robot are rotated first, so that those ahead come first.
    pub action: Option<Action>,
    /// The number of matching percepts in which the action bumped; at least 1, at most a billion.
    pub hits: u32,
    /// The number of matching percepts in which the action moved; at most a billion.
    pub misses: u32,
}

/// A rule that the action `turn` numbers further, modulo the number of actions, undoes any action.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InverseActionRule {
    /// The difference between the action numbers.
    pub turn: Action,
    /// How often the action led back; at most a billion.
    pub hits: u32,
    /// How often the action led elsewhere; at most a billion.
    pub misses: u32,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn collision(hits: u32) -> CollisionRule {
        let condition = "01##".parse().unwrap();
        CollisionRule {
            condition,
            action: None,
            hits,
            misses: 0,
        }
    }

    fn back(turn: usize) -> InverseActionRule {
        let turn = Action::new(turn).unwrap();
        InverseActionRule {
            turn,
            hits: 2,
            misses: 0,
        }
    }

    #[test]
    fn invalid_rules_are_named_in_the_error() {
        let check = |collisions, returns| {
            Generalisation {
                collisions,
                returns,
            }
            .check(4)
        };
        assert_eq!(check(vec![collision(1)], vec![back(2), back(3)]), Ok(()));
        for (fault, collisions, returns) in [
            ("counts 0 hits", vec![collision(0)], vec![]),
            ("01## is listed twice", vec![collision(1); 2], vec![]),
            ("of turn 4 counts", vec![], vec![back(4)]),
            ("of turn 2 is listed twice", vec![], vec![back(2); 2]),
            ("10001 collision rules", vec![collision(1); 10_001], vec![]),
        ] {
            let said = check(collisions, returns).unwrap_err();
            assert!(said.contains(fault), "{said}");
        }
    }
}
