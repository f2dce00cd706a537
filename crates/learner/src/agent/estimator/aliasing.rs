//! Evidence that several cells share a percept: one percept and one move have led to different percepts.
//!
//! A move that slips leads elsewhere, too, so the direction in which the robot has really moved is inferred first, from
//! the cells that both percepts show. What cannot be told in this way counts only as long as no move was seen to slip.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::agent::estimator::map::association::{MapStep, RobotModel};
use crate::agent::estimator::map::bump::Bump;
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
        step: &MapStep,
        next: Option<&Percept>,
        robot: &RobotModel,
    ) {
        self.steps = self.steps.saturating_add(1);
        if step.bumped == Bump::Yes {
            return;
        }
        let around = next.map(|next| robot.vision.around(next));
        let possible: Vec<usize> = robot.possible_moves(step, around.as_ref()).collect();
        let chosen = robot.motion.certain(step.action);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::agent::estimator::map::motion_model::MotionModel;
    use crate::agent::estimator::map::place::{CellState, Surroundings, Vision, percept_of};
    use xcs::Action;

    /// A corridor from west to east, at its western end, in its middle, and at its eastern end.
    fn corridor(free: [bool; 2]) -> Surroundings {
        let mut around = [CellState::Wall; 8];
        for (at, _) in [6, 2].into_iter().zip(free).filter(|one| one.1) {
            around[at] = CellState::Free;
        }
        around
    }

    /// Learns from moves to the east between such places, as often as that.
    fn learned(moves: &[(Surroundings, Surroundings)], times: usize) -> Aliasing {
        let robot = RobotModel {
            motion: MotionModel::known(4),
            vision: Vision::LookedUp,
            slip: 1e-4,
            observation_error: 1e-4,
        };
        let mut aliasing = Aliasing::default();
        for (around, next) in moves.iter().cycle().take(times * moves.len()) {
            let step = MapStep {
                around: *around,
                action: Action::new(1).unwrap(),
                found: 0.0,
                bumped: Bump::No,
            };
            let next = percept_of(next);
            aliasing.learn(&percept_of(around), &step, Some(&next), &robot);
        }
        aliasing
    }

    #[test]
    fn one_percept_from_which_a_move_leads_to_two_is_that_of_several_cells_unless_moves_slip() {
        let [west, middle, east] = [[false, true], [true, true], [true, false]].map(corridor);
        // Of a corridor of four cells and one of three: the second cells share a percept.
        let exact = [(west, middle), (middle, middle), (middle, east)];
        assert!(learned(&exact, 30).is_certain());
        assert!(!learned(&exact, 3).is_certain(), "too few steps");
        let slips = [exact[0], exact[1], exact[2], (middle, west)];
        assert!(!learned(&slips, 30).is_certain(), "the last one went west");
        let alike = [exact[0], exact[2]];
        assert!(!learned(&alike, 100).is_certain(), "control: three cells");
    }
}
