//! Evidence that several cells share a percept: one percept and one move have led to different percepts.
//!
//! A move that slips leads elsewhere, too, so the direction in which the robot has really moved is inferred first, from
//! the cells that both percepts show. What cannot be told in this way counts only as long as no move was seen to slip.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::align::{Habits, Seen};
use super::bumped::Bumped;
use xcs::Percept;

/// Contradictions that are needed: a percept may be misread, and what is met once or twice hardly matters.
const NEEDED: u32 = 3;
/// Steps without a slip after which all moves are taken for exact.
const STEPS_WITHOUT_SLIP: u32 = 64;

/// What has followed each percept and move, and how often that was contradictory.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Aliasing {
    /// By percept and direction of a move that is certain: the percept after it, or `None` for a goal.
    moves: BTreeMap<(Percept, u8), Option<Percept>>,
    /// The same by percept and chosen action, right if no move slips.
    choices: BTreeMap<(Percept, u8), Option<Percept>>,
    contradicted_moves: u32,
    contradicted_choices: u32,
    /// Moves that went another way than the chosen one.
    slipped: u32,
    steps: u32,
}

impl Aliasing {
    /// Learns from a step and the percept after it, `None` at a goal.
    pub fn learn(
        &mut self,
        percept: &Percept,
        step: &Seen,
        next: Option<&Percept>,
        habits: &Habits,
    ) {
        self.steps = self.steps.saturating_add(1);
        if step.bumped == Bumped::Yes {
            return;
        }
        let around = next.map(|next| habits.vision.around(next));
        let possible: Vec<usize> = habits.possible_moves(step, around.as_ref()).collect();
        let chosen = habits.headings.certain(step.action);
        if chosen.is_some_and(|chosen| !possible.contains(&chosen)) {
            // None is possible where a cell was misread.
            self.slipped += u32::from(!possible.is_empty());
        }
        let next = next.copied();
        let key = |number: usize| (*percept, u8::try_from(number).expect("at most eight"));
        match possible[..] {
            [only] => {
                let before = *self.moves.entry(key(only)).or_insert(next);
                self.contradicted_moves += u32::from(before != next);
            }
            [] => return,
            _ => {}
        }
        let before = *self.choices.entry(key(step.action.index())).or_insert(next);
        self.contradicted_choices += u32::from(before != next);
    }

    /// Do several cells share a percept?
    pub fn is_certain(&self) -> bool {
        let are_exact = self.slipped == 0 && self.steps >= STEPS_WITHOUT_SLIP;
        self.contradicted_moves >= NEEDED || are_exact && self.contradicted_choices >= NEEDED
    }
}
