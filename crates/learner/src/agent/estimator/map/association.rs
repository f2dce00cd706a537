//! Aligns an episode that ended at the goal with a map. The forward-backward algorithm (Baum and Welch)
//! runs over its steps, from the map's goal outward.

use crate::agent::estimator::map::cell_counts::{CellCounts, UNSEEN};
use crate::agent::estimator::map::likelihood::Likelihood;
use crate::agent::estimator::map::messages::{Accumulator, Message};
use crate::agent::estimator::map::motion_model::DISPLACEMENTS;
use crate::agent::estimator::map::place::{Place, offset};
use crate::agent::estimator::map::robot_model::{MapStep, RobotModel, likely_moves};

/// The alignment of an episode with a map.
#[derive(Debug, Clone, PartialEq)]
pub struct Alignment {
    /// The likelihood of the episode on the map.
    pub likelihood: Likelihood,
    /// For each step, the robot's cell, if it is certain.
    pub places: Vec<Option<Place>>,
    /// The expected number of slips, given the map.
    pub slips: f64,
    /// For each step, the likelihood of each displacement given the map and all other steps.
    pub fits: Vec<[f64; DISPLACEMENTS]>,
}

/// Aligns an episode that ended at the goal with a map. Steps outside every map get no cell.
pub fn align(steps: &[MapStep], cell_map: &CellCounts, robot: &RobotModel) -> Alignment {
    let mut accumulator = Accumulator::new();
    let (messages, likelihood) = backward(steps, cell_map, robot, &mut accumulator);
    let beyond = steps.len() + 1 - messages.len();
    let within = forward(&steps[beyond..], &messages, robot, &mut accumulator);
    let no_place = std::iter::repeat_n(None, beyond);
    let no_evidence = std::iter::repeat_n([1.0; DISPLACEMENTS], beyond);
    Alignment {
        likelihood: (0..beyond).fold(likelihood, |likelihood, _| likelihood.times(UNSEEN)),
        places: no_place.chain(within.places).collect(),
        slips: within.slips,
        fits: no_evidence.chain(within.fits).collect(),
    }
}

/// Returns the backward message of each step. The earliest steps are left out if they are outside every
/// map.
fn backward(
    steps: &[MapStep],
    cell_map: &CellCounts,
    robot: &RobotModel,
    accumulator: &mut Accumulator,
) -> (Vec<Message>, Likelihood) {
    let mut later = Message::only(Place::ORIGIN);
    let mut likelihood = Likelihood::ONE;
    let mut messages = Vec::with_capacity(steps.len());
    for (at, step) in steps.iter().enumerate().rev() {
        let moves = likely_moves(step, steps.get(at + 1).map(|next| &next.around), robot);
        for &(place, weight) in &later.places {
            for &(displacement, likely) in &moves {
                accumulator.add(place.minus(offset(displacement)), weight * likely);
            }
        }
        if accumulator.is_mostly_beyond() {
            accumulator.take_message();
            break;
        }
        accumulator.weigh(|place| match place {
            // The episode would have ended there.
            Place::ORIGIN => 0.0,
            _ => cell_map.likelihood(place, &step.around, robot.observation_error),
        });
        let (message, greatest) = accumulator.take_message();
        likelihood = likelihood.times(greatest);
        messages.push(std::mem::replace(&mut later, message));
    }
    messages.push(later);
    messages.reverse();
    (messages, likelihood)
}

/// Runs the forward pass. Returns the certain cells, the expected slips and the likelihoods of
/// displacements.
fn forward(
    steps: &[MapStep],
    messages: &[Message],
    robot: &RobotModel,
    accumulator: &mut Accumulator,
) -> Alignment {
    let mut now = messages[0].shares();
    let mut forward = Alignment {
        likelihood: Likelihood::ONE,
        places: Vec::with_capacity(steps.len()),
        slips: 0.0,
        fits: Vec::with_capacity(steps.len()),
    };
    for (at, step) in steps.iter().enumerate() {
        forward.places.push(now.certain());
        let mut fits = [0.0; DISPLACEMENTS];
        let moves = likely_moves(step, steps.get(at + 1).map(|next| &next.around), robot);
        let later = &messages[at + 1];
        let slipped = robot.slipped(step);
        for &(place, weight) in &now.places {
            let successors: Vec<(usize, Place, f64, f64)> = moves
                .iter()
                .filter_map(|&(displacement, likely)| {
                    let to = place.plus(offset(displacement));
                    Some((displacement, to, likely, later.of(to)?))
                })
                .collect();
            let all: f64 = successors.iter().map(|one| one.2 * one.3).sum();
            for (displacement, to, likely, after) in successors {
                let share = weight * (likely * after) / all;
                forward.slips += share * slipped[displacement];
                fits[displacement] += weight * after / all;
                accumulator.add(to, share);
            }
        }
        forward.fits.push(fits);
        now = accumulator.take_message().0.shares();
    }
    forward
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::agent::estimator::map::cell_counts::FURTHEST;
    use crate::agent::estimator::map::place::CellState;

    const EAST: usize = 2;

    /// A corridor episode that begins `cells` cells east of its goal and goes straight to it.
    fn from_the_east(cells: i16) -> Vec<MapStep> {
        let step = |east: i16| {
            let mut around = [CellState::Wall; 8];
            around[EAST] = [CellState::Free, CellState::Wall][usize::from(east == cells)];
            around[EAST + 4] = [CellState::Free, CellState::Goal][usize::from(east == 1)];
            MapStep::moved(around, EAST + 4)
        };
        (1..=cells).rev().map(step).collect()
    }

    #[test]
    fn steps_beyond_the_reach_of_a_map_get_no_cell_and_all_others_the_right_one() {
        for cells in [30, 80, 150] {
            let steps = from_the_east(cells);
            let robot = RobotModel::known(0.05, 5e-4);
            let aligned = align(&steps, &CellCounts::default(), &robot);
            for (place, east) in aligned.places.iter().zip((1..=cells).rev()) {
                let expected = (east <= FURTHEST as i16).then_some(Place::new(east, 0));
                assert_eq!(*place, expected, "{cells} cells");
            }
        }
    }

    #[test]
    fn steps_beyond_the_reach_of_a_map_do_not_change_the_motion_model() {
        let mut robot = RobotModel::known(0.05, 5e-4);
        let before = robot.motion;
        let steps = from_the_east(80);
        let aligned = align(&steps, &CellCounts::default(), &robot);
        robot.learn_in_context(&steps[0], &aligned.fits[0]);
        let west = steps[0].action;
        assert_eq!(robot.motion.certain(west), before.certain(west));
    }
}
