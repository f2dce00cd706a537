//! The estimated models of a robot's motion and observation, and the likelihood of its steps without a map.

use crate::agent::estimator::map::bump::Bump;
use crate::agent::estimator::map::motion_model::{DISPLACEMENTS, MotionModel};
use crate::agent::estimator::map::place::{
    CellState, NEIGHBOURS, NOWHERE, Place, Surroundings, Vision, offset,
};
use xcs::Action;
use xcscr_robot::world::each_other;

/// A step: the percept and the chosen action.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct MapStep {
    /// The cells around the robot.
    pub around: Surroundings,
    /// The chosen action.
    pub action: Action,
    /// The auxiliary reward collected by the action, or 0.
    pub found: f64,
    /// Whether the robot bumped, and stayed in its cell.
    pub bumped: Bump,
}

/// The estimated models of motion and observation.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RobotModel {
    /// The displacement that each action aims at.
    pub motion: MotionModel,
    /// How the robot perceives the cells around it. A setting.
    #[serde(skip)]
    pub vision: Vision,
    /// The probability that an action other than the chosen one is executed.
    pub slip: f64,
    /// The probability that a cell is observed wrongly.
    pub observation_error: f64,
}

impl RobotModel {
    /// Returns the probability of each displacement: the eight directions, and none.
    fn displacements(&self, step: &MapStep) -> [f64; DISPLACEMENTS] {
        let mut likely = [0.0; DISPLACEMENTS];
        let actions = self.motion.actions();
        for action in Action::all(actions) {
            let executed = match action == step.action {
                true => 1.0 - self.slip,
                false => each_other(self.slip, actions),
            };
            for (heading, weight) in self.motion.of(action) {
                for (to, fits) in self.leads(step, heading) {
                    likely[to] += weight * fits * executed;
                }
            }
        }
        likely
    }

    /// Returns the displacements of a robot that aims at `heading`, with or without a bump. Each comes
    /// with its likelihood given the percept.
    fn leads(&self, step: &MapStep, heading: usize) -> impl Iterator<Item = (usize, f64)> {
        step.bumped.possible().map(move |bumped| {
            let fits = self.fits_ahead(step, heading, bumped);
            (if bumped { NOWHERE } else { heading }, fits)
        })
    }

    /// Returns the likelihood of the perceived cell ahead, given a bump or no bump.
    fn fits_ahead(&self, step: &MapStep, heading: usize, bumped: bool) -> f64 {
        let is_felt = step.bumped != Bump::Unfelt;
        match step.around.get(heading) {
            Some(CellState::Hidden) if is_felt => 1.0,
            Some(CellState::Hidden) => 0.5,
            state if (state == Some(&CellState::Wall)) == bumped => 1.0,
            // The next percept shows whether the robot has moved there ([`Self::fit`]).
            _ if !is_felt && !bumped => 1.0,
            _ => self.observation_error,
        }
    }

    /// Returns the directions in which some action may have moved the robot, given the percepts before
    /// and after the step (no percept at the goal).
    pub fn possible_moves(
        &self,
        step: &MapStep,
        next: Option<&Surroundings>,
    ) -> impl Iterator<Item = usize> {
        (0..NEIGHBOURS.len()).filter(move |&along| {
            let mut actions = Action::all(self.motion.actions());
            let is_aimed_at =
                actions.any(|action| self.motion.of(action).any(|(to, _)| to == along));
            // The robot comes from a free cell.
            let opposite = (along + NEIGHBOURS.len() / 2) % NEIGHBOURS.len();
            let is_closed = next.is_some_and(|next| next[opposite] == CellState::Wall);
            let is_possible = step.around[along] != CellState::Wall && !is_closed;
            is_aimed_at && is_possible && self.fit(step, next, along) == 1.0
        })
    }

    /// Returns the probability of a slip, by displacement.
    pub fn slipped(&self, step: &MapStep) -> [f64; DISPLACEMENTS] {
        let mut chosen = [0.0; DISPLACEMENTS];
        for (heading, weight) in self.motion.of(step.action) {
            for (to, fits) in self.leads(step, heading) {
                chosen[to] += weight * fits * (1.0 - self.slip);
            }
        }
        let all = self.displacements(step);
        std::array::from_fn(|to| match all[to] > 0.0 {
            true => 1.0 - chosen[to] / all[to],
            false => 0.0,
        })
    }

    /// Returns the probability of a slip, given the next percept (none at the goal).
    fn share_of_slips(&self, step: &MapStep, next: Option<&Surroundings>) -> f64 {
        let (mut slips, mut all) = (0.0, 0.0);
        let slipped = self.slipped(step);
        for (displacement, likely) in likely_moves(step, next, self) {
            slips += likely * slipped[displacement];
            all += likely;
        }
        if all > 0.0 { slips / all } else { 0.0 }
    }

    /// Returns the likelihood of both percepts given a displacement (no next percept at the goal).
    fn fit(&self, step: &MapStep, next: Option<&Surroundings>, displacement: usize) -> f64 {
        let cell = step.around.get(displacement).copied();
        match next {
            None if cell.is_some_and(|cell| self.vision.may_be_goal(cell)) => 1.0,
            Some(next) if cell != Some(CellState::Goal) => {
                overlap(&step.around, next, displacement, self.observation_error)
            }
            _ => self.observation_error,
        }
    }

    /// Updates an action's motion model from the likelihoods of displacements in the whole episode.
    pub fn learn_in_context(&mut self, step: &MapStep, fits: &[f64; DISPLACEMENTS]) {
        let fits = std::array::from_fn(|heading| match step.bumped {
            Bump::No => fits[heading],
            Bump::Yes => fits[NOWHERE],
            Bump::Unfelt => self
                .leads(step, heading)
                .map(|(to, fit)| fit * fits[to])
                .sum(),
        });
        self.motion.learn(step.action, &fits, self.slip);
    }

    /// Updates an action's motion model from the percepts before and after it.
    pub fn learn_heading(&mut self, step: &MapStep, next: Option<&Surroundings>) {
        let fits = std::array::from_fn(|heading| {
            let moves = self.leads(step, heading);
            moves
                .map(|(to, fits)| fits * self.fit(step, next, to))
                .sum()
        });
        self.motion.learn(step.action, &fits, self.slip);
    }
}

/// Compares two successive percepts, given a displacement. Yields whether they agree, for each cell that
/// both show.
fn shown_twice(
    before: &Surroundings,
    after: &Surroundings,
    displacement: usize,
) -> impl Iterator<Item = bool> {
    let by = offset(displacement);
    NEIGHBOURS
        .iter()
        .zip(before)
        .filter_map(move |(place, &state)| {
            let there = place.minus(by);
            if there == Place::ORIGIN {
                return Some(matches!(state, CellState::Free | CellState::Hidden));
            }
            let other = NEIGHBOURS.iter().position(|place| *place == there)?;
            let hidden = [state, after[other]].contains(&CellState::Hidden);
            (!hidden).then_some(state == after[other])
        })
}

/// Returns the likelihood of two successive percepts, given a displacement: both must agree.
fn overlap(
    before: &Surroundings,
    after: &Surroundings,
    displacement: usize,
    observation_error: f64,
) -> f64 {
    let differing = shown_twice(before, after, displacement).filter(|agree| !agree);
    differing.fold(1.0, |product, _| product * observation_error)
}

/// Returns how many cells differ between successive percepts of an episode, and how many were shown
/// twice. A difference is an observation error in one of the two percepts. No map is needed.
pub fn differing(steps: &[MapStep], robot: &RobotModel) -> [f64; 2] {
    let mut counts = [0.0; 2];
    for pair in steps.windows(2) {
        let displacement = likeliest(&pair[0], &pair[1].around, robot);
        for agree in shown_twice(&pair[0].around, &pair[1].around, displacement) {
            counts[0] += f64::from(u8::from(!agree));
            counts[1] += 1.0;
        }
    }
    counts
}

/// Returns the expected number of slips in an episode, given pairs of successive percepts. No map is
/// used: on an incomplete map, slips back to known cells seem likelier than new cells, and each wrongly
/// counted slip makes further ones seem likelier.
pub fn slips(steps: &[MapStep], robot: &RobotModel) -> f64 {
    let after = |at: usize| steps.get(at + 1).map(|next| &next.around);
    let steps = steps.iter().enumerate();
    steps
        .map(|(at, step)| robot.share_of_slips(step, after(at)))
        .sum()
}

/// Returns the possible displacements of a step with their likelihoods, given the next percept (none at
/// the goal).
pub fn likely_moves(
    step: &MapStep,
    next: Option<&Surroundings>,
    robot: &RobotModel,
) -> Vec<(usize, f64)> {
    let likely = robot.displacements(step).into_iter().enumerate();
    let fitting = likely
        .map(|(displacement, likely)| (displacement, likely * robot.fit(step, next, displacement)));
    fitting.filter(|(_, likely)| *likely > 0.0).collect()
}

/// Returns the most likely displacement of a step, given the next percept.
pub fn likeliest_move(step: &MapStep, next: &Surroundings, robot: &RobotModel) -> Place {
    offset(likeliest(step, next, robot))
}

fn likeliest(step: &MapStep, next: &Surroundings, robot: &RobotModel) -> usize {
    let moves = likely_moves(step, Some(next), robot);
    let better = |best: (usize, f64), one: (usize, f64)| if one.1 > best.1 { one } else { best };
    let likeliest = moves.into_iter().reduce(better);
    likeliest.map_or(NOWHERE, |(displacement, _)| displacement)
}

#[cfg(test)]
impl RobotModel {
    /// A robot with exact percepts and a known motion model for eight actions.
    pub fn known(slip: f64, observation_error: f64) -> Self {
        Self {
            motion: MotionModel::known(8),
            vision: Vision::GroundTruth,
            slip,
            observation_error,
        }
    }
}

#[cfg(test)]
impl MapStep {
    /// A step without a bump and a reward.
    pub fn moved(around: Surroundings, action: usize) -> Self {
        Self {
            around,
            action: Action::new(action).expect("a valid action"),
            found: 0.0,
            bumped: Bump::No,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EAST: usize = 2;

    /// Returns the most likely displacement of a robot in a corridor from west to east that aims at the
    /// east. The percepts before and after the step are equal.
    fn moved(ahead: CellState, bumped: Bump) -> usize {
        let robot = RobotModel::known(1e-4, 0.02);
        let mut around = [CellState::Wall; 8];
        around[EAST] = ahead;
        around[EAST + 4] = CellState::Free;
        let step = MapStep {
            bumped,
            ..MapStep::moved(around, EAST)
        };
        likeliest(&step, &around, &robot)
    }

    #[test]
    fn bumps_decide_with_a_bumper_and_percepts_decide_without_one() {
        for ahead in [CellState::Free, CellState::Wall] {
            assert_eq!(moved(ahead, Bump::No), EAST, "{ahead:?}");
            assert_eq!(moved(ahead, Bump::Yes), NOWHERE, "{ahead:?}");
        }
        assert_eq!(moved(CellState::Free, Bump::Unfelt), EAST);
        assert_eq!(moved(CellState::Wall, Bump::Unfelt), NOWHERE);
    }
}
