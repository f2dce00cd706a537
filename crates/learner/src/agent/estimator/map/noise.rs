//! How often moves slip and how often cells are misread, where both may happen: learned from percepts
//! that follow each other, without a map. A cell that was misread looks as if the robot had gone another
//! way; so all headings of a step are weighed by all that both percepts show (theorem of Bayes).

use crate::agent::estimator::map::association::{MapStep, RobotModel};
use crate::agent::estimator::map::bump::Bump;
use crate::agent::estimator::map::motion_model::DISPLACEMENTS;
use crate::agent::estimator::map::place::{CellState, NEIGHBOURS, Place, Surroundings, offset};
use crate::agent::model::slips::each_other;
use xcs::Action;

/// The states that a reading can show.
const STATES: [CellState; 3] = [CellState::Free, CellState::Wall, CellState::Goal];

/// What is counted in steps, each as often as it is likely.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct NoiseCounts {
    /// Steps that slipped, and all of them.
    pub slips: [f64; 2],
    /// Cells in which two percepts differ, and all that both show.
    pub differing: [f64; 2],
}

impl NoiseCounts {
    /// Counts in all steps of episodes that reached the goal.
    pub fn of<'a>(
        episodes: impl Iterator<Item = &'a Vec<MapStep>> + Clone,
        robot: &RobotModel,
    ) -> Self {
        let readings = Readings::of(episodes.clone().flatten(), robot);
        let mut tally = Self::default();
        for steps in episodes {
            for (at, step) in steps.iter().enumerate() {
                tally.count(&readings.ways(step, steps.get(at + 1).map(|next| &next.around)));
            }
        }
        tally
    }

    fn count(&mut self, ways: &[Way]) {
        let all: f64 = ways.iter().map(|way| way.weight).sum();
        self.slips[1] += 1.0;
        for way in ways {
            let share = way.weight / all;
            self.slips[0] += share * way.slipped;
            let counts = self.differing.iter_mut().zip(way.differing);
            counts.for_each(|(sum, count)| *sum += share * count);
        }
    }
}

/// A heading that a step may have had, and whether it bumped.
struct Way {
    /// How likely it is beside the others.
    weight: f64,
    /// How likely the step slipped if so.
    slipped: f64,
    /// Cells in which two percepts differ, and all that both show.
    differing: [f64; 2],
}

/// How likely cell states are read.
struct Readings<'a> {
    robot: &'a RobotModel,
    /// In a cell of which nothing is known.
    anywhere: [f64; 3],
    /// After the first state was read in the same cell, the second.
    again: [[f64; 3]; 3],
}

/// What is known of a cell before it is read.
enum Known {
    Nothing,
    /// It was read so, perhaps wrongly.
    Read(CellState),
    /// The robot stood there, or bumped against it.
    Felt(CellState),
}

impl<'a> Readings<'a> {
    fn of<'b>(steps: impl Iterator<Item = &'b MapStep>, robot: &'a RobotModel) -> Self {
        let mut anywhere = [1.0; 3];
        let seen = steps.flat_map(|step| step.around);
        seen.filter(|state| *state != CellState::Hidden)
            .for_each(|state| anywhere[state as usize] += 1.0);
        let all: f64 = anywhere.iter().sum();
        let anywhere = anywhere.map(|count| count / all);
        let read = |state, is| felt(state, is, robot.observation_error);
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

    /// The headings that a step may have had, given what was seen after it (nothing at the goal).
    fn ways(&self, step: &MapStep, next: Option<&Surroundings>) -> Vec<Way> {
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
        let ways = likely.flat_map(|(heading, [meant, slipped])| {
            ends(step, next.is_none()).map(move |bumped| {
                let (fits, differing) = self.follows(step, next, (heading, bumped));
                Way {
                    weight: (meant + slipped) * fits,
                    slipped: slipped / (meant + slipped),
                    differing,
                }
            })
        });
        ways.collect()
    }

    /// How likely what is seen before and after a step is if it had a heading and bumped, or did not; in how
    /// many cells the two differ, and how many both show.
    fn follows(
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
                Known::Felt(is) => felt(state, is, self.robot.observation_error),
                Known::Read(first) => {
                    differing[0] += f64::from(u8::from(first != state));
                    differing[1] += 1.0;
                    self.again[first as usize][state as usize]
                }
            };
        }
        (fits, differing)
    }

    /// How much likelier than anywhere the cell ahead is read as it is: what the robot then felt of it. Of
    /// one that felt nothing, how likely the cell is like that, too.
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
        let likelier =
            felt(state, is, self.robot.observation_error) / self.anywhere[state as usize];
        match step.bumped {
            Bump::Unfelt => likelier * self.anywhere[is as usize],
            _ => likelier,
        }
    }
}

/// May a step have bumped, and may it not have? Who is at the goal has not.
fn ends(step: &MapStep, at_goal: bool) -> impl Iterator<Item = bool> {
    let possible = step.bumped.possible();
    possible.filter(move |bumped| !(at_goal && *bumped))
}

/// How likely a cell that is known to be this is read so: both wrong state equally often.
fn felt(state: CellState, is: CellState, observation_error: f64) -> f64 {
    if state == is {
        1.0 - observation_error
    } else {
        observation_error / 2.0
    }
}

/// What a step that had a heading and bumped, or did not, tells of a cell, counted from where it began.
fn known(step: &MapStep, (heading, bumped): (usize, bool), cell: Place) -> Known {
    let at = NEIGHBOURS.iter().position(|place| *place == cell);
    match at {
        _ if cell == Place::ORIGIN => Known::Felt(CellState::Free),
        Some(at) if bumped && at == heading => Known::Felt(CellState::Wall),
        Some(at) if step.around[at] != CellState::Hidden => Known::Read(step.around[at]),
        _ => Known::Nothing,
    }
}
