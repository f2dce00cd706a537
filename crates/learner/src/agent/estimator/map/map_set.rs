//! All maps, drawn from the episodes that reached a goal.

mod noisy;
mod relabelling;
mod re_estimation;

use std::collections::{BTreeMap, VecDeque};

use serde::{Deserialize, Serialize};

use crate::agent::estimator::map::association::{
    Alignment, MapStep, RobotModel, align, differing, slips,
};
use crate::agent::estimator::map::bump::Bump;
use crate::agent::estimator::map::cell_counts::CellCounts;
use crate::agent::estimator::map::hypothesis::{KEPT_STEPS, MapHypothesis, always_in, is_count};
use crate::agent::estimator::map::likelihood::Likelihood;
use crate::agent::estimator::map::motion_model::{DISPLACEMENTS, MotionModel};
use crate::agent::estimator::map::noise::NoiseCounts;
use crate::agent::estimator::map::params::{MapParams, MotionPrior};
use crate::agent::estimator::map::place::{Place, Surroundings, Vision};
use crate::agent::estimator::map::state_map::{MOST_MAPS, Map, MappedCells, RewardScale};
use crate::agent::estimator::map::tracker::Felt;

/// Episodes that are kept to draw the maps anew.
const KEPT_EPISODES: usize = 100;
/// After so many successes the maps are drawn anew, if moves slip.
const REDRAWN_AFTER: [u32; 17] = [
    5, 10, 15, 20, 30, 40, 50, 65, 80, 100, 130, 160, 200, 300, 400, 600, 800,
];
/// Moves that slip less than this are taken for exact.
const EXACT: f64 = 0.008;
/// What is believed of slips and misread cells at first.
const FIRST_SLIP: f64 = 0.05;
const LEAST_OBSERVATION_ERROR: f64 = 0.0005;
/// Looked-up percepts of which cells are misread less often than this are taken for right; sensed
/// ones are never held for better than this.
const RIGHT: f64 = 0.002;
/// How often moves slip counts as so many steps if it is brought from another world.
const BROUGHT_STEPS: f64 = 100.0;
/// So many cells must have differed before percepts are taken for noisy.
const LEAST_DIFFERING: f64 = 3.0;
/// Cells that were shown twice count beside so many that did not differ.
const SHOWN_AT_FIRST: f64 = 50.0;
/// How many times likelier an episode must be on a blank map, to open one for it.
const BLANK_ADVANTAGE: f64 = 7.4;
/// How often what is believed of slips and misread cells is improved after each episode.
const ESTIMATED: usize = 3;
/// A map that fewer episodes than this share belong to is not planned on.
const LEAST_SHARE: f64 = 0.05;

/// The maps, what is believed of moves and percepts, and the episodes that say so.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MapSet {
    hypotheses: Vec<MapHypothesis>,
    robot: RobotModel,
    /// Expected slips, and the steps among which they were counted.
    slips: [f64; 2],
    /// Cells in which two percepts differ, and all that two percepts show.
    observation_error: [f64; 2],
    episodes: VecDeque<Vec<MapStep>>,
    /// Maps of another world, which all drawing begins with.
    brought: Vec<MapHypothesis>,
    successes: u32,
    /// How often moves slip in plans, which do not change with every estimate.
    planned_slip: f64,
    /// By action: what it was certain to aim at after the last success. Maps and map are drawn with
    /// it, so that a map that is drawn again after an interruption is the same.
    planned_with: Vec<Option<usize>>,
    #[serde(skip)]
    params: MapParams,
}

impl MapSet {
    /// An maps without a map, for a robot with so many actions.
    pub fn new(actions: usize, vision: Vision, params: MapParams) -> Self {
        let robot = RobotModel {
            motion: match params.motion_model {
                MotionPrior::Known => MotionModel::known(actions),
                MotionPrior::Learned => MotionModel::unknown(actions),
            },
            vision,
            slip: FIRST_SLIP,
            observation_error: least_observation_error(vision),
        };
        Self {
            hypotheses: Vec::new(),
            robot,
            slips: [0.0; 2],
            observation_error: [0.0; 2],
            episodes: VecDeque::new(),
            brought: Vec::new(),
            successes: 0,
            planned_slip: 0.0,
            planned_with: robot.motion.all_certain(),
            params,
        }
    }

    /// The same with the settings of another.
    pub fn with_settings_of(mut self, other: &Self) -> Self {
        self.params = other.params.clone();
        self.robot.vision = other.robot.vision;
        self
    }

    /// Takes over the maps of a map that was drawn in another world. Each counts as one episode:
    /// one that nothing bears out is soon too rare to plan on.
    pub fn bring(&mut self, map: &Map) {
        for (map_state, state) in map
            .states
            .iter()
            .zip(0..)
            .filter(|(map_state, _)| map_state.collected == 0)
        {
            let at = usize::from(map_state.cell_map);
            while self.brought.len() <= at {
                let (number, goal) = (self.brought.len() as u8, self.robot.vision.of_a_goal());
                self.brought.push(MapHypothesis::transferred(number, goal));
            }
            let around = self.robot.vision.around(map.pomdp.percept(state));
            let hypothesis = &mut self.brought[at];
            hypothesis.cell_map.add(map_state.place, &around);
            if map.begin == Some(state) {
                hypothesis.always_begins_in(map_state.place);
            }
        }
        for hypothesis in &mut self.brought {
            hypothesis.cell_map = std::mem::take(&mut hypothesis.cell_map).seen_once();
        }
        self.hypotheses = self.brought.clone();
        self.planned_slip = map.pomdp.slip();
        self.slips = [BROUGHT_STEPS * map.pomdp.slip(), BROUGHT_STEPS];
        self.update_robot_model();
    }

    /// The same with no maps but those that were brought and without an episode, but for what is
    /// believed of moves and percepts.
    fn blank(&self) -> Self {
        let RobotModel { motion, vision, .. } = &self.robot;
        Self {
            robot: self.robot,
            hypotheses: self.brought.clone(),
            brought: self.brought.clone(),
            successes: self.successes,
            ..Self::new(motion.actions(), *vision, self.params.clone())
        }
    }

    /// What is believed of moves and percepts.
    pub fn robot(&self) -> &RobotModel {
        &self.robot
    }

    /// Does the robot feel whether it bumped?
    pub fn feels_bumps(&self) -> bool {
        self.params.feels_bumps
    }

    /// What the robot feels of a wall that barred its way.
    pub fn bumped(&self, felt: Felt) -> Bump {
        match felt.bumped {
            _ if !self.params.feels_bumps => Bump::Unfelt,
            true => Bump::Yes,
            false => Bump::No,
        }
    }

    /// Learns from a step and what was seen after it (nothing at the goal) what its action aims at, if
    /// that is not known.
    pub fn follow(&mut self, step: &MapStep, next: Option<&Surroundings>) {
        if self.params.motion_model == MotionPrior::Learned {
            self.robot.learn_heading(step, next);
        }
    }

    /// Learns from an episode whose last step led to a goal.
    pub fn learn(&mut self, mut steps: Vec<MapStep>) {
        steps.drain(..steps.len().saturating_sub(KEPT_STEPS));
        self.successes = self.successes.saturating_add(1);
        if self.params.estimates_noise {
            self.compare(&steps);
        }
        let fits = self.draw(&steps);
        if self.params.motion_model == MotionPrior::Learned {
            let steps = steps.iter().zip(&fits);
            steps.for_each(|(step, fits)| self.robot.learn_in_context(step, fits));
        }
        self.episodes.push_back(steps);
        if self.episodes.len() > KEPT_EPISODES {
            self.episodes.pop_front();
        }
        self.update_robot_model();
        if self.doubts() && self.params.motion_model == MotionPrior::Known {
            self.estimate();
        }
        let inexact = self.robot.slip >= EXACT || self.observation_error() > 0.0;
        let certain = self.robot.motion.all_certain();
        if certain != self.planned_with || REDRAWN_AFTER.contains(&self.successes) && inexact {
            self.re_estimate();
            self.planned_with = certain;
        }
        self.planned_slip = slip_to_plan_with(self.robot.slip, self.planned_slip);
    }

    /// Compares what percepts of an episode show that follow each other, to learn how often cells
    /// are misread.
    fn compare(&mut self, steps: &[MapStep]) {
        let differing = differing(steps, &self.robot);
        let fading = 0.99;
        let sums = self.observation_error.iter_mut().zip(differing);
        sums.for_each(|(sum, count)| *sum = *sum * fading + count);
        self.settle_noisy();
    }

    /// Compares successive percepts; true once more than [`RIGHT`] of the cells are misread.
    pub fn notices_noise(&mut self, steps: &[MapStep]) -> bool {
        if self.params.estimates_noise {
            self.compare(steps);
        }
        self.observation_error[0] >= LEAST_DIFFERING && self.robot.observation_error > RIGHT
    }

    fn settle_noisy(&mut self) {
        let [differing, all] = self.observation_error;
        // Either of the two percepts was wrong.
        let observation_error = differing / 2.0 / (all + SHOWN_AT_FIRST);
        self.robot.observation_error =
            observation_error.clamp(least_observation_error(self.robot.vision), 0.25);
    }

    /// Learns from all kept episodes together how often moves slip and cells are misread: each is
    /// judged by how often the other is believed to happen.
    fn estimate(&mut self) {
        for _ in 0..ESTIMATED {
            let tally = NoiseCounts::of(self.episodes.iter(), &self.robot);
            (self.slips, self.observation_error) = (tally.slips, tally.differing);
            self.update_robot_model();
            self.settle_noisy();
        }
    }

    /// Are cells misread of which the robot is told what they are?
    fn doubts(&self) -> bool {
        self.robot.vision == Vision::LookedUp && self.observation_error() > 0.0
    }

    /// How often cells are misread; 0 if that is so rare that percepts are taken for right, which those
    /// of a lidar never are.
    fn observation_error(&self) -> f64 {
        match self.robot.vision {
            Vision::LookedUp if self.robot.observation_error < RIGHT => 0.0,
            _ => self.robot.observation_error,
        }
    }

    /// Takes an episode down on the map that it fits best; tells how well displacements fit there.
    fn draw(&mut self, steps: &[MapStep]) -> Vec<[f64; DISPLACEMENTS]> {
        let (at, alignment) = match self.doubts() {
            true => self.associate_noisily(steps),
            false => self.associate(steps),
        };
        if at == self.hypotheses.len() {
            self.hypotheses.push(MapHypothesis::default());
        }
        let hypothesis = &mut self.hypotheses[at];
        hypothesis.add(steps, &alignment);
        let goal = self.robot.vision.of_a_goal();
        hypothesis.cell_map.sight(Place::ORIGIN, goal);
        let fading = 0.99;
        self.slips[0] = self.slips[0] * fading + self.slips_of(steps, &alignment);
        self.slips[1] = self.slips[1] * fading + steps.len() as f64;
        alignment.fits
    }

    /// How many steps of an episode slipped. While directions are being learned, a step that goes another way
    /// than it seemed to aim is no slip, and only the map tells.
    fn slips_of(&self, steps: &[MapStep], alignment: &Alignment) -> f64 {
        match self.params.motion_model {
            MotionPrior::Known => slips(steps, &self.robot),
            MotionPrior::Learned => alignment.slips,
        }
    }

    /// The map that an episode fits best, and how it lies there; `None` if there is no map.
    fn best_fit(&self, steps: &[MapStep]) -> Option<(usize, Alignment)> {
        let cell_maps = self
            .hypotheses
            .iter()
            .map(|hypothesis| &hypothesis.cell_map)
            .enumerate();
        let laid = cell_maps.map(|(at, cell_map)| (at, align(steps, cell_map, &self.robot)));
        laid.reduce(|best, one| match one.1.likelihood > best.1.likelihood {
            true => one,
            false => best,
        })
    }

    /// The same, or the number of a new map, if the episode fits none of them.
    fn associate(&self, steps: &[MapStep]) -> (usize, Alignment) {
        let blank = || {
            let new = self.hypotheses.len();
            (new, align(steps, &CellCounts::default(), &self.robot))
        };
        let Some(best) = self.best_fit(steps) else {
            return blank();
        };
        if self.hypotheses.len() >= self.params.max_maps as usize {
            return best;
        }
        let Some(least) = self.least_to_open(steps, &best) else {
            return best;
        };
        let blank = blank();
        if blank.1.likelihood > least {
            blank
        } else {
            best
        }
    }

    /// How likely an episode must be on a blank map to open one for it; `None` if nothing speaks against
    /// the one that it fits best. If cells are misread, none by itself speaks against a map; but a blank
    /// one tells nothing, so the episode must be twice as likely there for each cell that the other tells.
    fn least_to_open(&self, steps: &[MapStep], best: &(usize, Alignment)) -> Option<Likelihood> {
        let [contradicted, seen] = self.contradictions(steps, best);
        let likelihood = best.1.likelihood;
        let likelier = likelihood.times(BLANK_ADVANTAGE);
        if self.observation_error() > 0.0 {
            return Some(likelier.doubled(seen));
        }
        match self.robot.slip < EXACT {
            true => (contradicted > 0).then_some(likelihood.times(0.0)),
            false => (contradicted > 1).then_some(likelier),
        }
    }

    /// In how many cells an episode contradicts the map on which it lies, and how many mapped cells it
    /// sees.
    fn contradictions(
        &self,
        steps: &[MapStep],
        (at, alignment): &(usize, Alignment),
    ) -> [usize; 2] {
        let cell_map = &self.hypotheses[*at].cell_map;
        let placed = steps.iter().zip(&alignment.places);
        let placed = placed.filter_map(|(step, place)| Some((step, (*place)?)));
        let mut cells: BTreeMap<Place, bool> = BTreeMap::new();
        for (cell, agrees) in placed.flat_map(|(step, place)| cell_map.compare(place, &step.around))
        {
            *cells.entry(cell).or_default() |= !agrees;
        }
        let contradicted = cells.values().filter(|contradicted| **contradicted);
        [contradicted.count(), cells.len()]
    }

    /// How often moves slip, as far as the last episodes tell.
    fn update_robot_model(&mut self) {
        let [slips, steps] = self.slips;
        self.robot.slip = ((slips + FIRST_SLIP) / (steps + 1.0)).clamp(1e-4, 0.9);
    }

    /// The mapped places as states to plan on, on all maps that are not rare.
    pub fn map(&self, values: &RewardScale) -> Map {
        let all: f64 = self
            .hypotheses
            .iter()
            .map(|hypothesis| hypothesis.episodes)
            .sum();
        let used = self.hypotheses.iter();
        let used = used.filter(|hypothesis| hypothesis.episodes >= LEAST_SHARE * all);
        let mapped: Vec<MappedCells<'_>> = used
            .clone()
            .map(|hypothesis| {
                MappedCells::new(
                    &hypothesis.cell_map,
                    &hypothesis.payments,
                    self.robot.vision,
                )
            })
            .collect();
        let map = Map::drawn(&mapped, &self.planned_with, self.planned_slip, values);
        Map {
            observation_error: self.observation_error(),
            unfelt: !self.params.feels_bumps,
            ..map.begun_in(always_in(used))
        }
    }

    /// Can the maps of a robot with so many actions look like this?
    pub fn is_sound(&self, actions: usize) -> bool {
        let steps = self.episodes.iter().flatten();
        self.robot.motion.is_sound(actions)
            && self.planned_with.len() == actions
            && self
                .planned_with
                .iter()
                .flatten()
                .all(|&heading| heading < DISPLACEMENTS)
            && self.hypotheses.len() <= MOST_MAPS
            && self.brought.len() <= MOST_MAPS
            && self
                .hypotheses
                .iter()
                .flat_map(|hypothesis| hypothesis.transferred)
                .all(|number| usize::from(number) < self.brought.len())
            && [&self.hypotheses, &self.brought]
                .into_iter()
                .flatten()
                .all(MapHypothesis::is_sound)
            && self.episodes.iter().all(|steps| steps.len() <= KEPT_STEPS)
            && steps
                .clone()
                .all(|step| step.action.index() < actions && step.found.is_finite())
            && [self.slips, self.observation_error]
                .iter()
                .flatten()
                .all(is_count)
            && (0.0..=1.0).contains(&self.robot.slip)
            && (0.0..=1.0).contains(&self.planned_slip)
            && (0.0..=1.0).contains(&self.robot.observation_error)
    }
}

/// The least share of cells that is taken for misread.
fn least_observation_error(vision: Vision) -> f64 {
    match vision {
        Vision::LookedUp => LEAST_OBSERVATION_ERROR,
        Vision::Lidar => RIGHT,
    }
}

/// How often moves slip in plans, if they seem to slip so often: in steps of a fiftieth, and as
/// `before` while that is as good. Each change makes all plans worthless.
fn slip_to_plan_with(slip: f64, before: f64) -> f64 {
    match slip < EXACT {
        true => 0.0,
        false if before > 0.0 && (slip - before).abs() < 0.02 => before,
        false => (slip * 50.0).round() / 50.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn association_and_belief_weigh_percepts_of_a_lidar_by_the_same_error() {
        let maps = |vision| MapSet::new(8, vision, MapParams::default());
        let lidar = maps(Vision::Lidar);
        assert_eq!(lidar.robot.observation_error, lidar.observation_error());
        let exact = maps(Vision::LookedUp);
        assert_eq!(
            (exact.robot.observation_error, exact.observation_error()),
            (LEAST_OBSERVATION_ERROR, 0.0),
            "control"
        );
    }
}
