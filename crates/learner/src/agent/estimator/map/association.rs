//! Where an episode that ended at the goal must have led: forward and backward over its steps
//! (Baum and Welch), from the goal of a map outward.

use crate::agent::estimator::map::bump::Bump;
use crate::agent::estimator::map::cell_counts::{CellCounts, UNSEEN};
use crate::agent::estimator::map::likelihood::Likelihood;
use crate::agent::estimator::map::messages::{Accumulator, Message};
use crate::agent::estimator::map::motion_model::{DISPLACEMENTS, MotionModel};
use crate::agent::estimator::map::place::{
    CellState, NEIGHBOURS, NOWHERE, Place, Surroundings, Vision, offset,
};
use crate::agent::model::slips::each_other;
use xcs::Action;

/// A step: what was perceived, and what was chosen.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct MapStep {
    /// The cells around the robot.
    pub around: Surroundings,
    /// The action that it chose.
    pub action: Action,
    /// The auxiliary reward that it found by it, or 0.
    pub found: f64,
    /// Did it bump, and stay where it was?
    pub bumped: Bump,
}

/// What is believed of the moves and of the percepts.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RobotModel {
    /// The displacement that each action aims at.
    pub motion: MotionModel,
    /// How the cells around the robot are seen. A setting.
    #[serde(skip)]
    pub vision: Vision,
    /// The probability that another action than the chosen one is executed.
    pub slip: f64,
    /// The probability that a cell is misread.
    pub observation_error: f64,
}

impl RobotModel {
    /// How likely each displacement is: the eight around, and none.
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

    /// The displacements that a robot may have that heads for one, and how well what was perceived
    /// fits to that it bumped, or did not.
    fn leads(&self, step: &MapStep, heading: usize) -> impl Iterator<Item = (usize, f64)> {
        step.bumped.possible().map(move |bumped| {
            let fits = self.fits_ahead(step, heading, bumped);
            (if bumped { NOWHERE } else { heading }, fits)
        })
    }

    /// How well the cell ahead, as it was perceived, fits to that the robot bumped, or did not.
    fn fits_ahead(&self, step: &MapStep, heading: usize, bumped: bool) -> f64 {
        let is_felt = step.bumped != Bump::Unfelt;
        match step.around.get(heading) {
            Some(CellState::Hidden) if is_felt => 1.0,
            Some(CellState::Hidden) => 0.5,
            state if (state == Some(&CellState::Wall)) == bumped => 1.0,
            // What comes next tells whether the robot has gone there ([`Self::fit`]).
            _ if !is_felt && !bumped => 1.0,
            _ => self.observation_error,
        }
    }

    /// The directions into which some action may have moved the robot, by what was seen before and after the step (nothing
    /// at the goal).
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

    /// By displacement, how likely a step was a slip if it displaced the robot so.
    fn slipped(&self, step: &MapStep) -> [f64; DISPLACEMENTS] {
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

    /// How likely a step was a slip, given what was seen after it (nothing at the goal).
    fn share_of_slips(&self, step: &MapStep, next: Option<&Surroundings>) -> f64 {
        let (mut slips, mut all) = (0.0, 0.0);
        let slipped = self.slipped(step);
        for (displacement, likely) in likely_moves(step, next, self) {
            slips += likely * slipped[displacement];
            all += likely;
        }
        if all > 0.0 { slips / all } else { 0.0 }
    }

    /// How well a displacement fits to what was seen before and after it (nothing at the goal).
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

    /// Learns what an action aims at, from how well displacements fit to the rest of the episode.
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

    /// Learns what an action aims at, from what was seen before and after it.
    pub fn learn_heading(&mut self, step: &MapStep, next: Option<&Surroundings>) {
        let fits = std::array::from_fn(|heading| {
            let ways = self.leads(step, heading);
            ways.map(|(to, fits)| fits * self.fit(step, next, to)).sum()
        });
        self.motion.learn(step.action, &fits, self.slip);
    }
}

/// What both of two percepts show that follow each other over a displacement: for each such cell,
/// whether they agree.
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

/// How likely two percepts follow each other over a displacement: what both show must agree.
fn overlap(
    before: &Surroundings,
    after: &Surroundings,
    displacement: usize,
    observation_error: f64,
) -> f64 {
    let differing = shown_twice(before, after, displacement).filter(|agree| !agree);
    differing.fold(1.0, |product, _| product * observation_error)
}

/// How many cells of an episode were shown twice, in two percepts that follow each other, and in
/// how many of them these two differ: one of them was misread. This needs no map.
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

/// How an episode lies on a map.
#[derive(Debug, Clone, PartialEq)]
pub struct Alignment {
    /// How likely the episode is on the map: mantissa and power of two.
    pub likelihood: Likelihood,
    /// For each step, where the robot was, if that is certain.
    pub places: Vec<Option<Place>>,
    /// How many steps slipped, as far as the map tells.
    pub slips: f64,
    /// For each step, how well each displacement fits to the map and to all other steps.
    pub fits: Vec<[f64; DISPLACEMENTS]>,
}

/// Aligns an episode, which ended at the goal, with a map. Steps that lie beyond every map have no place.
pub fn align(steps: &[MapStep], cell_map: &CellCounts, robot: &RobotModel) -> Alignment {
    let mut adder = Accumulator::new();
    let (layers, likelihood) = backward(steps, cell_map, robot, &mut adder);
    let beyond = steps.len() + 1 - layers.len();
    let within = forward(&steps[beyond..], &layers, robot, &mut adder);
    let no_place = std::iter::repeat_n(None, beyond);
    let no_evidence = std::iter::repeat_n([1.0; DISPLACEMENTS], beyond);
    Alignment {
        likelihood: (0..beyond).fold(likelihood, |likelihood, _| likelihood.times(UNSEEN)),
        places: no_place.chain(within.places).collect(),
        slips: within.slips,
        fits: no_evidence.chain(within.fits).collect(),
    }
}

/// For each step the likelihood of what follows, by place; the earliest steps are left out if they lie beyond every map.
fn backward(
    steps: &[MapStep],
    cell_map: &CellCounts,
    robot: &RobotModel,
    adder: &mut Accumulator,
) -> (Vec<Message>, Likelihood) {
    let mut later = Message::only(Place::ORIGIN);
    let mut likelihood = Likelihood::ONE;
    let mut layers = Vec::with_capacity(steps.len());
    for (at, step) in steps.iter().enumerate().rev() {
        let moves = likely_moves(step, steps.get(at + 1).map(|next| &next.around), robot);
        for &(place, weight) in &later.places {
            for &(displacement, likely) in &moves {
                adder.add(place.minus(offset(displacement)), weight * likely);
            }
        }
        if adder.is_mostly_beyond() {
            adder.layer();
            break;
        }
        adder.weigh(|place| match place {
            // The episode would have ended there.
            Place::ORIGIN => 0.0,
            _ => cell_map.likelihood(place, &step.around, robot.observation_error),
        });
        let (layer, greatest) = adder.layer();
        likelihood = likelihood.times(greatest);
        layers.push(std::mem::replace(&mut later, layer));
    }
    layers.push(later);
    layers.reverse();
    (layers, likelihood)
}

/// How many steps of an episode slipped, as far as two percepts that follow each other tell. This needs
/// no map: on a map that ends too soon, moves that slip back to what is known seem likelier than new
/// places, and the more are taken for slips the likelier they seem.
pub fn slips(steps: &[MapStep], robot: &RobotModel) -> f64 {
    let after = |at: usize| steps.get(at + 1).map(|next| &next.around);
    let steps = steps.iter().enumerate();
    steps
        .map(|(at, step)| robot.share_of_slips(step, after(at)))
        .sum()
}

/// The displacements that a step may have had, given what was seen after it (nothing at the goal).
fn likely_moves(
    step: &MapStep,
    next: Option<&Surroundings>,
    robot: &RobotModel,
) -> Vec<(usize, f64)> {
    let likely = robot.displacements(step).into_iter().enumerate();
    let fitting = likely
        .map(|(displacement, likely)| (displacement, likely * robot.fit(step, next, displacement)));
    fitting.filter(|(_, likely)| *likely > 0.0).collect()
}

/// Where the robot was at each step, where that is certain, how often it slipped, and how well
/// displacements fit.
fn forward(
    steps: &[MapStep],
    layers: &[Message],
    robot: &RobotModel,
    adder: &mut Accumulator,
) -> Alignment {
    let mut now = layers[0].shares();
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
        let later = &layers[at + 1];
        let slipped = robot.slipped(step);
        for &(place, weight) in &now.places {
            let ways: Vec<(usize, Place, f64, f64)> = moves
                .iter()
                .filter_map(|&(displacement, likely)| {
                    let to = place.plus(offset(displacement));
                    Some((displacement, to, likely, later.of(to)?))
                })
                .collect();
            let all: f64 = ways.iter().map(|way| way.2 * way.3).sum();
            for (displacement, to, likely, after) in ways {
                let share = weight * (likely * after) / all;
                forward.slips += share * slipped[displacement];
                fits[displacement] += weight * after / all;
                adder.add(to, share);
            }
        }
        forward.fits.push(fits);
        now = adder.layer().0.shares();
    }
    forward
}

/// The displacement that a step most likely had, given what was seen after it.
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
mod tests {
    use super::*;
    use crate::agent::estimator::map::cell_counts::FURTHEST;

    const EAST: usize = 2;

    /// How a robot in a corridor from west to east has most likely moved that headed for the east, and saw
    /// this there before and after.
    fn moved(ahead: CellState, bumped: Bump) -> usize {
        let robot = RobotModel {
            motion: MotionModel::known(8),
            vision: Vision::LookedUp,
            slip: 1e-4,
            observation_error: 0.02,
        };
        let mut around = [CellState::Wall; 8];
        around[EAST] = ahead;
        around[EAST + 4] = CellState::Free;
        let step = MapStep {
            around,
            action: Action::new(EAST).unwrap(),
            found: 0.0,
            bumped,
        };
        likeliest(&step, &around, &robot)
    }

    #[test]
    fn who_feels_bumps_goes_by_them_and_who_does_not_by_what_it_sees() {
        for ahead in [CellState::Free, CellState::Wall] {
            assert_eq!(moved(ahead, Bump::No), EAST, "{ahead:?}");
            assert_eq!(moved(ahead, Bump::Yes), NOWHERE, "{ahead:?}");
        }
        assert_eq!(moved(CellState::Free, Bump::Unfelt), EAST);
        assert_eq!(moved(CellState::Wall, Bump::Unfelt), NOWHERE);
    }

    /// An episode that begins so many cells to the east of its goal, in a corridor, and goes straight there.
    fn from_the_east(cells: i16) -> Vec<MapStep> {
        let step = |east: i16| {
            let mut around = [CellState::Wall; 8];
            around[EAST] = [CellState::Free, CellState::Wall][usize::from(east == cells)];
            around[EAST + 4] = [CellState::Free, CellState::Goal][usize::from(east == 1)];
            MapStep {
                around,
                action: Action::new(EAST + 4).unwrap(),
                found: 0.0,
                bumped: Bump::No,
            }
        };
        (1..=cells).rev().map(step).collect()
    }

    fn robot(motion: MotionModel) -> RobotModel {
        RobotModel {
            motion,
            vision: Vision::LookedUp,
            slip: 0.05,
            observation_error: 5e-4,
        }
    }

    #[test]
    fn steps_beyond_the_reach_of_a_map_have_no_place_and_all_others_the_right_one() {
        for cells in [30, 80, 150] {
            let steps = from_the_east(cells);
            let aligned = align(
                &steps,
                &CellCounts::default(),
                &robot(MotionModel::known(8)),
            );
            for (place, east) in aligned.places.iter().zip((1..=cells).rev()) {
                let expected = (east <= FURTHEST as i16).then_some(Place::new(east, 0));
                assert_eq!(*place, expected, "{cells} cells");
            }
        }
    }

    #[test]
    fn steps_beyond_the_reach_of_a_map_teach_nothing_about_the_motion_model() {
        let mut robot = robot(MotionModel::known(8));
        let before = robot.motion;
        let steps = from_the_east(80);
        let aligned = align(&steps, &CellCounts::default(), &robot);
        robot.learn_in_context(&steps[0], &aligned.fits[0]);
        let west = steps[0].action;
        assert_eq!(robot.motion.certain(west), before.certain(west));
        assert!(robot.motion.is_sound(8));
    }
}
