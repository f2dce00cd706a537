//! General rules that foretell what an action does, as they are read and carried from maze to
//! maze.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use xcs::Action;
use xcs::Condition;

/// What `xcscr-plus` has learned about moving, apart from any maze.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Generalisation {
    /// When an action ends in a collision.
    pub collisions: Vec<CollisionRule>,
    /// Which action leads back.
    pub returns: Vec<ReturnRule>,
}

/// The most that a rule may have counted.
const MOST_COUNTED: u32 = 1_000_000_000;
/// Every rule about collisions is asked at every step.
const MOST_COLLISION_RULES: usize = 10_000;

impl Generalisation {
    /// Accepts rules about `actions` actions, none of them twice, whose counts can be.
    ///
    /// # Errors
    /// What is wrong with the first rule that cannot be.
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

impl ReturnRule {
    fn check(&self, actions: usize, seen: &mut BTreeSet<Action>) -> Result<(), String> {
        let Self { turn, hits, misses } = self;
        let number = turn.index();
        if number >= actions || hits.max(misses) > &MOST_COUNTED {
            return Err(format!(
                "the return rule of turn {number} counts {hits} hits and {misses} misses: there are {actions} actions, and at most {MOST_COUNTED} can be counted"
            ));
        }
        match seen.insert(*turn) {
            true => Ok(()),
            false => Err(format!("the return rule of turn {number} is listed twice")),
        }
    }
}

/// Percepts that match the condition foretell a collision.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CollisionRule {
    /// Which percepts it matches.
    pub condition: Condition,
    /// Of which action it speaks. `None`: of every action, if the bits of the percept that lie in
    /// a ring around the robot are turned first, so that those ahead come first.
    pub action: Option<Action>,
    /// Matching percepts in which the action bumped; at least 1, at most a billion.
    pub hits: u32,
    /// Matching percepts in which it moved; at most a billion.
    pub misses: u32,
}

/// Any action is undone by the one that is `turn` numbers further, counted in a circle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReturnRule {
    /// How many numbers further.
    pub turn: Action,
    /// How often that led back; at most a billion.
    pub hits: u32,
    /// How often it led elsewhere; at most a billion.
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

    fn back(turn: usize) -> ReturnRule {
        let turn = Action::new(turn).unwrap();
        ReturnRule {
            turn,
            hits: 2,
            misses: 0,
        }
    }

    #[test]
    fn rules_that_cannot_be_are_named() {
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
