//! Data association with observation noise. It maximises the likelihood of all observations, summed over
//! the possible states of the cells. A redundant map costs the prior of its cells, and two goals on one
//! map cost their contradictions.

use crate::agent::estimator::map::association::{Alignment, align};
use crate::agent::estimator::map::cell_counts::CellCounts;
use crate::agent::estimator::map::map_set::MapSet;
use crate::agent::estimator::map::observations::Observations;
use crate::agent::estimator::map::robot_model::MapStep;
use xcscr_robot::world::each_other;

/// The least advantage of an empty map over an existing one, in bits, to open a new map.
pub(super) const OPENING_COST: f64 = 3.0;
/// The cost of a step without a certain cell, in bits, as if all surrounding cells were unknown.
const UNPLACED_COST: f64 = 9.0;

/// An episode assigned to a map.
#[derive(Debug, Clone)]
pub(super) struct Assignment {
    /// The number of the map.
    pub at: usize,
    pub alignment: Alignment,
    /// The episode's observations of cells.
    pub seen: Observations,
    /// The log2 likelihood of the moves.
    pub bits: f64,
}

impl MapSet {
    /// Aligns an episode with map number `at`.
    fn assign_to(&self, steps: &[MapStep], at: usize, cell_map: &CellCounts) -> Assignment {
        let alignment = align(steps, cell_map, &self.robot);
        let unplaced = alignment.places.iter().filter(|place| place.is_none());
        let slip = libm::log2(each_other(self.robot.slip, self.robot.motion.actions()));
        Assignment {
            at,
            seen: Observations::of(steps, &alignment.places, self.robot.vision.of_a_goal()),
            bits: alignment.slips * slip - UNPLACED_COST * unplaced.count() as f64,
            alignment,
        }
    }

    /// Returns the number of maps that are not empty.
    pub(super) fn used(&self) -> usize {
        self.hypotheses
            .iter()
            .filter(|hypothesis| hypothesis.episodes > 0.0)
            .count()
    }

    /// Returns the number of an empty map, if another one is allowed.
    pub(super) fn room(&self) -> Option<usize> {
        let empty = self
            .hypotheses
            .iter()
            .position(|hypothesis| hypothesis.episodes == 0.0);
        let room = self.used() < self.params.max_maps as usize;
        room.then(|| empty.unwrap_or(self.hypotheses.len()))
    }

    /// Assigns an episode to the likeliest map, given the observations on each. It may be an empty map.
    pub(super) fn likeliest(
        &self,
        steps: &[MapStep],
        seen: &[Observations],
        may_open: bool,
    ) -> Assignment {
        let observation_error = self.robot.observation_error;
        let assigned = self.hypotheses.iter().enumerate();
        let assigned = assigned.filter(|(_, hypothesis)| hypothesis.episodes > 0.0);
        let assigned = assigned.map(|(at, hypothesis)| {
            let assigned = self.assign_to(steps, at, &hypothesis.cell_map);
            let bits = assigned.bits + seen[at].bits_of(&assigned.seen, observation_error);
            (assigned, bits)
        });
        let room = self.room().filter(|_| may_open || self.used() == 0);
        let empty = room.map(|at| {
            let assigned = self.assign_to(steps, at, &CellCounts::default());
            let bits = assigned.bits + assigned.seen.bits(observation_error) - OPENING_COST;
            (assigned, bits)
        });
        let all = assigned.chain(empty);
        let best = all.reduce(|best, one| if one.1 > best.1 { one } else { best });
        best.expect("there is a map, or room for one").0
    }

    /// Assigns an episode to the likeliest map, given the observations that the maps hold.
    pub(super) fn associate_noisily(&self, steps: &[MapStep]) -> (usize, Alignment) {
        let assigned = self.likeliest(steps, &self.seen_on_maps(), true);
        (assigned.at, assigned.alignment)
    }

    /// Returns the observations on each map.
    pub(super) fn seen_on_maps(&self) -> Vec<Observations> {
        let hypotheses = self.hypotheses.iter();
        hypotheses
            .map(|hypothesis| Observations::of_map(&hypothesis.cell_map))
            .collect()
    }
}
