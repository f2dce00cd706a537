//! Detects perceptual aliasing: the same percept and move have led to different percepts.
//!
//! A slip leads elsewhere, too. The direction of the actual move is therefore inferred first, from the
//! cells that both percepts show. Moves of unknown direction count only while no slip was observed.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::agent::estimator::map::bump::Bump;
use crate::agent::estimator::map::robot_model::{MapStep, RobotModel};
use xcs::Percept;

/// The number of contradictions required. Percepts may have errors, and rare contradictions matter
/// little.
const LEAST_CONTRADICTIONS: u32 = 3;
/// The number of steps without a slip after which all moves are treated as exact.
const STEPS_WITHOUT_SLIP: u32 = 64;

/// The percept that followed each percept and move, and the number of contradictions.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Aliasing {
    /// By percept and direction of a certain move: the next percept, or `None` for a goal.
    moves: BTreeMap<(Percept, u8), Option<Percept>>,
    /// By percept and chosen action: the next percept. Correct if no move slips.
    choices: BTreeMap<(Percept, u8), Option<Percept>>,
    contradicted_moves: u32,
    contradicted_choices: u32,
    /// The number of moves in another direction than the chosen one.
    slipped: u32,
    steps: u32,
}

impl Aliasing {
    /// Learns from a step and the next percept (`None` at a goal).
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
            // No move is possible if a cell was observed wrongly.
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

    /// Returns true if there is enough evidence that several cells share a percept.
    pub fn is_certain(&self) -> bool {
        let are_exact = self.slipped == 0 && self.steps >= STEPS_WITHOUT_SLIP;
        self.contradicted_moves >= LEAST_CONTRADICTIONS
            || are_exact && self.contradicted_choices >= LEAST_CONTRADICTIONS
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::agent::estimator::map::motion_model::MotionModel;
    use crate::agent::estimator::map::place::{CellState, Surroundings, percept_of};

    /// The western end, the middle or the eastern end of a corridor from west to east.
    fn corridor(free: [bool; 2]) -> Surroundings {
        let mut around = [CellState::Wall; 8];
        for (at, _) in [6, 2].into_iter().zip(free).filter(|one| one.1) {
            around[at] = CellState::Free;
        }
        around
    }

    /// Learns from moves to the east between these surroundings, repeated `times` times.
    fn learned(moves: &[(Surroundings, Surroundings)], times: usize) -> Aliasing {
        let robot = RobotModel {
            motion: MotionModel::known(4),
            ..RobotModel::known(1e-4, 1e-4)
        };
        let mut aliasing = Aliasing::default();
        for (around, next) in moves.iter().cycle().take(times * moves.len()) {
            let step = MapStep::moved(*around, 1);
            let next = percept_of(next);
            aliasing.learn(&percept_of(around), &step, Some(&next), &robot);
        }
        aliasing
    }

    #[test]
    fn different_results_of_a_move_indicate_aliasing_unless_moves_slip() {
        let [west, middle, east] = [[false, true], [true, true], [true, false]].map(corridor);
        // From a corridor of four cells and one of three: their second cells share a percept.
        let exact = [(west, middle), (middle, middle), (middle, east)];
        assert!(learned(&exact, 30).is_certain());
        assert!(!learned(&exact, 3).is_certain(), "too few steps");
        let slips = [exact[0], exact[1], exact[2], (middle, west)];
        assert!(!learned(&slips, 30).is_certain(), "the last one went west");
        let aliased = [exact[0], exact[2]];
        assert!(!learned(&aliased, 100).is_certain(), "control: three cells");
    }
}
