//! General rules that foretell what an action does, as they are read and carried from maze to
//! maze.

use serde::{Deserialize, Serialize};

use crate::signal::Action;
use crate::xcs::Condition;

/// What `xcscr-plus` has learned about moving, apart from any maze.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Foresight {
    /// When an action ends in a collision.
    pub collisions: Vec<CollisionRule>,
    /// Which action leads back.
    pub returns: Vec<ReturnRule>,
}

/// The most that a rule may have counted.
const MOST_COUNTED: u32 = 1_000_000_000;

impl Foresight {
    /// Accepts rules about `actions` actions whose counts can be.
    ///
    /// # Errors
    /// What is wrong with the first rule that cannot be.
    pub(super) fn check(&self, actions: usize) -> Result<(), String> {
        for CollisionRule {
            condition,
            hits,
            misses,
            ..
        } in &self.collisions
        {
            if !(1..=MOST_COUNTED).contains(hits) || *misses > MOST_COUNTED {
                return Err(format!(
                    "the collision rule {condition} counts {hits} hits and {misses} misses: hits must be from 1 to {MOST_COUNTED}, misses from 0"
                ));
            }
        }
        for ReturnRule { turn, hits, misses } in &self.returns {
            if turn.index() >= actions || hits.max(misses) > &MOST_COUNTED {
                let turn = turn.index();
                return Err(format!(
                    "the return rule of turn {turn} counts {hits} hits and {misses} misses: there are {actions} actions, and at most {MOST_COUNTED} can be counted"
                ));
            }
        }
        Ok(())
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
