//! Estimates slip probability and observation error together from successive percepts, without a map. An
//! observation error looks like a move in another direction. So all directions of a step are weighted by
//! the cells that both percepts show (Bayes' theorem).

use crate::agent::estimator::map::bump::Bump;
use crate::agent::estimator::map::motion_model::DISPLACEMENTS;
use crate::agent::estimator::map::place::{CellState, NEIGHBOURS, Place, Surroundings, offset};
use crate::agent::estimator::map::robot_model::{MapStep, RobotModel};
use xcs::Action;
use xcscr_robot::world::each_other;

/// The cell states that a percept can show.
const STATES: [CellState; 3] = [CellState::Free, CellState::Wall, CellState::Goal];

/// Expected counts over steps.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct NoiseCounts {
    /// The number of slips, and of all steps.
    pub slips: [f64; 2],
    /// The number of cells in which two successive percepts differ, and of all that both show.
    pub differing: [f64; 2],
}

impl NoiseCounts {
    /// Counts over all steps of episodes that reached the goal.
    pub fn of<'a>(
        episodes: impl Iterator<Item = &'a Vec<MapStep>> + Clone,
        robot: &RobotModel,
    ) -> Self {
        let model = ObservationModel::of(episodes.clone().flatten(), robot);
        let mut tally = Self::default();
        for steps in episodes {
            for (at, step) in steps.iter().enumerate() {
                tally
                    .count(&model.possible_moves(step, steps.get(at + 1).map(|next| &next.around)));
            }
        }
        tally
    }

    fn count(&mut self, possible_moves: &[PossibleMove]) {
        let all: f64 = possible_moves.iter().map(|possible| possible.weight).sum();
        self.slips[1] += 1.0;
        for possible in possible_moves {
            let share = possible.weight / all;
            self.slips[0] += share * possible.slipped;
            let counts = self.differing.iter_mut().zip(possible.differing);
            counts.for_each(|(sum, count)| *sum += share * count);
        }
    }
}

/// A possible direction of a step, with or without a bump.
struct PossibleMove {
    /// The weight relative to the other possible moves.
    weight: f64,
    /// The probability that this move is a slip.
    slipped: f64,
    /// The number of cells in which the two percepts differ, and of all that both show.
    differing: [f64; 2],
}

/// Probabilities of perceived cell states.
struct ObservationModel<'a> {
    robot: &'a RobotModel,
    /// In an unknown cell.
    anywhere: [f64; 3],
    /// By the first percept of a cell, the probabilities of the second one.
    again: [[f64; 3]; 3],
}

/// Knowledge about a cell before it is perceived.
enum Known {
    Nothing,
    /// The cell was perceived in this state, perhaps wrongly.
    Read(CellState),
    /// The robot was in the cell, or bumped into it.
    Certain(CellState),
}

impl<'a> ObservationModel<'a> {
    fn of<'b>(steps: impl Iterator<Item = &'b MapStep>, robot: &'a RobotModel) -> Self {
        let mut anywhere = [1.0; 3];
        let seen = steps.flat_map(|step| step.around);
        seen.filter(|state| *state != CellState::Hidden)
            .for_each(|state| anywhere[state as usize] += 1.0);
        let all: f64 = anywhere.iter().sum();
        let anywhere = anywhere.map(|count| count / all);
        let read = |state, is| reading_probability(state, is, robot.observation_error);
        let again = STATES.map(|first| {
            let both = STATES.map(|second| {
                let of =
                    STATES.map(|is| anywhere[is as usize] * read(first, is) * read(second, is));
                of.iter().sum::<f64>()
            });
            let all: f64 = both.iter().sum();
            both.map(|one| one / all)
        });
        Self {
            robot,
            anywhere,
            again,
        }
    }

    /// Returns the possible moves of a step, given the next percept (none at the goal).
    fn possible_moves(&self, step: &MapStep, next: Option<&Surroundings>) -> Vec<PossibleMove> {
        let RobotModel { motion, slip, .. } = self.robot;
        let mut likely = [[0.0; 2]; DISPLACEMENTS];
        for action in Action::all(motion.actions()) {
            for (heading, weight) in motion.of(action) {
                let [meant, slipped] = &mut likely[heading];
                match action == step.action {
                    true => *meant += weight * (1.0 - slip),
                    false => *slipped += weight * each_other(*slip, motion.actions()),
                }
            }
        }
        let likely = likely.into_iter().enumerate();
        let likely = likely.filter(|(_, [meant, slipped])| meant + slipped > 0.0);
        let possible_moves = likely.flat_map(|(heading, [meant, slipped])| {
            possible_bumps(step, next.is_none()).map(move |bumped| {
                let (fits, differing) = self.likelihood(step, next, (heading, bumped));
                PossibleMove {
                    weight: (meant + slipped) * fits,
                    slipped: slipped / (meant + slipped),
                    differing,
                }
            })
        });
        possible_moves.collect()
    }

    /// Returns the likelihood of the percepts before and after a move. Also returns the number of cells
    /// in which they differ, and of all that both show.
    fn likelihood(
        &self,
        step: &MapStep,
        next: Option<&Surroundings>,
        (heading, bumped): (usize, bool),
    ) -> (f64, [f64; 2]) {
        let mut fits = self.ahead(step, next.is_none(), (heading, bumped));
        let mut differing = [0.0; 2];
        let by = offset(if bumped { NEIGHBOURS.len() } else { heading });
        let seen = NEIGHBOURS.iter().zip(next.into_iter().flatten());
        for (place, &state) in seen.filter(|(_, state)| **state != CellState::Hidden) {
            fits *= match known(step, (heading, bumped), place.plus(by)) {
                Known::Nothing => self.anywhere[state as usize],
                Known::Certain(is) => reading_probability(state, is, self.robot.observation_error),
                Known::Read(first) => {
                    differing[0] += f64::from(u8::from(first != state));
                    differing[1] += 1.0;
                    self.again[first as usize][state as usize]
                }
            };
        }
        (fits, differing)
    }

    /// Returns the likelihood ratio of the perceived cell ahead, given what the bumper says about it.
    /// Without a bumper, the ratio includes the prior of the cell's actual state.
    fn ahead(&self, step: &MapStep, at_goal: bool, (heading, bumped): (usize, bool)) -> f64 {
        let Some(&state) = step.around.get(heading) else {
            return 1.0;
        };
        let is = match at_goal {
            _ if state == CellState::Hidden => return 1.0,
            _ if bumped => CellState::Wall,
            true => self.robot.vision.of_a_goal(),
            false => CellState::Free,
        };
        let likelier = reading_probability(state, is, self.robot.observation_error)
            / self.anywhere[state as usize];
        match step.bumped {
            Bump::Unfelt => likelier * self.anywhere[is as usize],
            _ => likelier,
        }
    }
}

/// Returns whether the step may have bumped, as possible values. A robot at the goal did not bump.
fn possible_bumps(step: &MapStep, at_goal: bool) -> impl Iterator<Item = bool> {
    let possible = step.bumped.possible();
    possible.filter(move |bumped| !(at_goal && *bumped))
}

/// Returns the probability of a perceived state, given the true one. Both wrong states are equally
/// likely.
fn reading_probability(state: CellState, is: CellState, observation_error: f64) -> f64 {
    if state == is {
        1.0 - observation_error
    } else {
        observation_error / 2.0
    }
}

/// Returns what a move reveals about a cell, given relative to the start of the move.
fn known(step: &MapStep, (heading, bumped): (usize, bool), cell: Place) -> Known {
    let at = NEIGHBOURS.iter().position(|place| *place == cell);
    match at {
        _ if cell == Place::ORIGIN => Known::Certain(CellState::Free),
        Some(at) if bumped && at == heading => Known::Certain(CellState::Wall),
        Some(at) if step.around[at] != CellState::Hidden => Known::Read(step.around[at]),
        _ => Known::Nothing,
    }
}
