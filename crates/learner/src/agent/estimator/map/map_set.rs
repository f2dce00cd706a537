//! The map set: all maps, estimated from the episodes that reached a goal.

mod noise_estimates;
mod noisy;
mod relabelling;
mod re_estimation;

use std::collections::{BTreeMap, VecDeque};

use serde::{Deserialize, Serialize};

use crate::agent::credit::params::Params;
use crate::agent::estimator::map::association::{Alignment, align};
use crate::agent::estimator::map::bump::Bump;
use crate::agent::estimator::map::cell_counts::CellCounts;
use crate::agent::estimator::map::hypothesis::{KEPT_STEPS, MapHypothesis, always_in};
use crate::agent::estimator::map::likelihood::Likelihood;
use crate::agent::estimator::map::map_set::noise_estimates::{FIRST_SLIP, least_observation_error};
use crate::agent::estimator::map::motion_model::{DISPLACEMENTS, MotionModel};
use crate::agent::estimator::map::params::{MapParams, MotionPrior};
use crate::agent::estimator::map::place::{Place, Surroundings, Vision};
use crate::agent::estimator::map::robot_model::{MapStep, RobotModel};
use crate::agent::estimator::map::state_map::{Map, MappedCells};
use crate::agent::estimator::map::tracker::Felt;

/// The number of stored episodes, from which the maps are re-estimated.
const KEPT_EPISODES: usize = 100;
/// The numbers of successes after which the maps are re-estimated, if moves slip.
const RE_ESTIMATED_AFTER: [u32; 17] = [
    5, 10, 15, 20, 30, 40, 50, 65, 80, 100, 130, 160, 200, 300, 400, 600, 800,
];
/// Moves with a smaller slip probability are treated as exact.
const EXACT: f64 = 0.008;
/// The number of steps that the slip probability of a transferred map counts for.
const TRANSFERRED_STEPS: f64 = 100.0;
/// The required likelihood ratio of an empty map over an existing one to open a new map.
const EMPTY_MAP_ADVANTAGE: f64 = 7.4;
/// The least share of episodes of a map that is planned on.
const LEAST_SHARE: f64 = 0.05;

/// The maps, the robot model, and the episodes from which they are estimated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MapSet {
    hypotheses: Vec<MapHypothesis>,
    robot: RobotModel,
    /// The expected number of slips, and the number of steps.
    slips: [f64; 2],
    /// The number of cells in which two percepts differ, and of all that both show.
    observation_error: [f64; 2],
    episodes: VecDeque<Vec<MapStep>>,
    /// The transferred maps, from which every estimation starts.
    brought: Vec<MapHypothesis>,
    successes: u32,
    /// The slip probability in plans. It does not change with every estimate.
    planned_slip: f64,
    /// By action, the certain displacement after the last success. The maps are built with these, so that
    /// an interrupted run builds the same maps after it is resumed.
    planned_with: Vec<Option<usize>>,
    #[serde(skip)]
    params: MapParams,
}

impl MapSet {
    /// Creates an empty map set for a robot with this number of actions.
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

    /// Adds the maps of another world. Each counts as one episode: a map that no episode confirms soon
    /// becomes too rare to plan on.
    pub fn warm_start(&mut self, map: &Map) {
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
        self.slips = [TRANSFERRED_STEPS * map.pomdp.slip(), TRANSFERRED_STEPS];
        self.update_robot_model();
    }

    /// Returns the map set with only the transferred maps and without episodes. The robot model is the
    /// same.
    fn without_episodes(&self) -> Self {
        let RobotModel { motion, vision, .. } = &self.robot;
        Self {
            robot: self.robot,
            hypotheses: self.brought.clone(),
            brought: self.brought.clone(),
            successes: self.successes,
            ..Self::new(motion.actions(), *vision, self.params.clone())
        }
    }

    /// Returns the estimated models of motion and observation.
    pub fn robot(&self) -> &RobotModel {
        &self.robot
    }

    /// Returns true if the robot uses its bumper.
    pub fn feels_bumps(&self) -> bool {
        self.params.feels_bumps
    }

    /// Converts the feedback of an action into a bumper reading.
    pub fn bumped(&self, felt: Felt) -> Bump {
        match felt.bumped {
            _ if !self.params.feels_bumps => Bump::Unfelt,
            true => Bump::Yes,
            false => Bump::No,
        }
    }

    /// Learns the motion model from a step and the next percept (none at the goal), unless it is known.
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
        let fits = self.add_episode(&steps);
        if self.params.motion_model == MotionPrior::Learned {
            let steps = steps.iter().zip(&fits);
            steps.for_each(|(step, fits)| self.robot.learn_in_context(step, fits));
        }
        self.episodes.push_back(steps);
        if self.episodes.len() > KEPT_EPISODES {
            self.episodes.pop_front();
        }
        self.update_robot_model();
        if self.has_noisy_percepts() && self.params.motion_model == MotionPrior::Known {
            self.estimate();
        }
        let inexact = self.robot.slip >= EXACT || self.observation_error() > 0.0;
        let certain = self.robot.motion.all_certain();
        if certain != self.planned_with || RE_ESTIMATED_AFTER.contains(&self.successes) && inexact {
            self.re_estimate();
            self.planned_with = certain;
        }
        self.planned_slip = slip_to_plan_with(self.robot.slip, self.planned_slip);
    }

    /// Adds an episode to the map it fits best. Returns the likelihoods of its displacements there.
    fn add_episode(&mut self, steps: &[MapStep]) -> Vec<[f64; DISPLACEMENTS]> {
        let (at, alignment) = match self.has_noisy_percepts() {
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

    /// Returns the best map for an episode and the alignment; `None` if there is no map.
    fn best_fit(&self, steps: &[MapStep]) -> Option<(usize, Alignment)> {
        let cell_maps = self
            .hypotheses
            .iter()
            .map(|hypothesis| &hypothesis.cell_map)
            .enumerate();
        let assigned = cell_maps.map(|(at, cell_map)| (at, align(steps, cell_map, &self.robot)));
        assigned.reduce(|best, one| match one.1.likelihood > best.1.likelihood {
            true => one,
            false => best,
        })
    }

    /// Returns the best map and the alignment, or the number of a new map if the episode fits none.
    fn associate(&self, steps: &[MapStep]) -> (usize, Alignment) {
        let empty = || {
            let new = self.hypotheses.len();
            (new, align(steps, &CellCounts::default(), &self.robot))
        };
        let Some(best) = self.best_fit(steps) else {
            return empty();
        };
        if self.hypotheses.len() >= self.params.max_maps as usize {
            return best;
        }
        let Some(least) = self.least_to_open(steps, &best) else {
            return best;
        };
        let empty = empty();
        if empty.1.likelihood > least {
            empty
        } else {
            best
        }
    }

    /// Returns the least likelihood on an empty map for which a new map is opened; `None` if the episode
    /// does not contradict the best map. With observation errors, single contradictions do not count. But
    /// an empty map predicts nothing, so the episode must be twice as likely there for each mapped cell
    /// it sees.
    fn least_to_open(&self, steps: &[MapStep], best: &(usize, Alignment)) -> Option<Likelihood> {
        let [contradicted, seen] = self.contradictions(steps, best);
        let likelihood = best.1.likelihood;
        let likelier = likelihood.times(EMPTY_MAP_ADVANTAGE);
        if self.observation_error() > 0.0 {
            return Some(likelier.doubled(seen));
        }
        match self.robot.slip < EXACT {
            true => (contradicted > 0).then_some(likelihood.times(0.0)),
            false => (contradicted > 1).then_some(likelier),
        }
    }

    /// Returns how many cells contradict the map of an episode, and how many mapped cells it sees.
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

    /// Returns the states to plan on, from all maps that are not rare.
    pub fn map(&self, params: &Params) -> Map {
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
        let map = Map::build(&mapped, &self.planned_with, self.planned_slip, params);
        Map {
            observation_error: self.observation_error(),
            unfelt: !self.params.feels_bumps,
            ..map.with_first_state(always_in(used))
        }
    }
}

/// Rounds a slip probability to fiftieths for planning. Keeps the value `before` while it is close,
/// because each change invalidates all plans.
fn slip_to_plan_with(slip: f64, before: f64) -> f64 {
    match slip < EXACT {
        true => 0.0,
        false if before > 0.0 && (slip - before).abs() < 0.02 => before,
        false => (slip * 50.0).round() / 50.0,
    }
}

/// Improves a set of maps by changing one of them. Tries each map in turn, and begins anew after each improvement.
fn climb<T>(
    mut best: T,
    maps: impl Fn(&T) -> usize,
    improved: impl Fn(&T, usize) -> Option<T>,
) -> T {
    let mut at = 0;
    while at < maps(&best) {
        (best, at) = match improved(&best, at) {
            Some(better) => (better, 0),
            None => (best, at + 1),
        };
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::agent::estimator::map::map_set::noise_estimates::LEAST_OBSERVATION_ERROR;

    #[test]
    fn association_and_belief_weigh_percepts_of_a_lidar_by_the_same_error() {
        let maps = |vision| MapSet::new(8, vision, MapParams::default());
        let lidar = maps(Vision::Lidar);
        assert_eq!(lidar.robot.observation_error, lidar.observation_error());
        let exact = maps(Vision::GroundTruth);
        assert_eq!(
            (exact.robot.observation_error, exact.observation_error()),
            (LEAST_OBSERVATION_ERROR, 0.0),
            "control"
        );
    }
}
