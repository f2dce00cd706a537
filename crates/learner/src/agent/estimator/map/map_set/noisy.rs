//! Maps where cells are misread: what all episodes saw of their cells, whatever these are, is to be as
//! likely as can be. So a place that is none costs what its cells could be, and two goals on one map cost
//! what contradicts itself.

use crate::agent::estimator::map::association::{Alignment, MapStep, align};
use crate::agent::estimator::map::cell_counts::CellCounts;
use crate::agent::estimator::map::map_set::MapSet;
use crate::agent::estimator::map::observations::Observations;
use crate::agent::model::slips::each_other;

/// How much likelier an episode must be on a blank map to open one for it, in bits.
pub(super) const TO_OPEN: f64 = 3.0;
/// What a step costs of which is not certain where it was: as if nothing were known of the cells around.
const LOST: f64 = 9.0;

/// How an episode lies on a map.
#[derive(Debug, Clone)]
pub(super) struct Laid {
    /// The number of the map.
    pub at: usize,
    pub alignment: Alignment,
    /// What it sees of the cells.
    pub seen: Observations,
    /// How likely its moves are, as a logarithm to the base 2.
    pub bits: f64,
}

impl MapSet {
    /// Lays an episode on a map, which has this number.
    fn lay_on(&self, steps: &[MapStep], at: usize, cell_map: &CellCounts) -> Laid {
        let alignment = align(steps, cell_map, &self.robot);
        let lost = alignment.places.iter().filter(|place| place.is_none());
        let slip = libm::log2(each_other(self.robot.slip, self.robot.motion.actions()));
        Laid {
            at,
            seen: Observations::of(steps, &alignment.places, self.robot.vision.of_a_goal()),
            bits: alignment.slips * slip - LOST * lost.count() as f64,
            alignment,
        }
    }

    /// How many maps are not blank.
    pub(super) fn used(&self) -> usize {
        self.hypotheses
            .iter()
            .filter(|hypothesis| hypothesis.episodes > 0.0)
            .count()
    }

    /// The number of a blank map, if there may be one more.
    pub(super) fn room(&self) -> Option<usize> {
        let blank = self
            .hypotheses
            .iter()
            .position(|hypothesis| hypothesis.episodes == 0.0);
        let room = self.used() < self.params.max_maps as usize;
        room.then(|| blank.unwrap_or(self.hypotheses.len()))
    }

    /// Where an episode is likeliest beside what was seen on each map, which may be a blank one.
    pub(super) fn likeliest(
        &self,
        steps: &[MapStep],
        seen: &[Observations],
        may_open: bool,
    ) -> Laid {
        let observation_error = self.robot.observation_error;
        let laid = self.hypotheses.iter().enumerate();
        let laid = laid.filter(|(_, hypothesis)| hypothesis.episodes > 0.0);
        let laid = laid.map(|(at, hypothesis)| {
            let laid = self.lay_on(steps, at, &hypothesis.cell_map);
            let bits = laid.bits + seen[at].bits_of(&laid.seen, observation_error);
            (laid, bits)
        });
        let room = self.room().filter(|_| may_open || self.used() == 0);
        let blank = room.map(|at| {
            let laid = self.lay_on(steps, at, &CellCounts::default());
            let bits = laid.bits + laid.seen.bits(observation_error) - TO_OPEN;
            (laid, bits)
        });
        let all = laid.chain(blank);
        let best = all.reduce(|best, one| if one.1 > best.1 { one } else { best });
        best.expect("there is a cell_map, or room for one").0
    }

    /// The same beside what maps hold.
    pub(super) fn associate_noisily(&self, steps: &[MapStep]) -> (usize, Alignment) {
        let laid = self.likeliest(steps, &self.seen_on_maps(), true);
        (laid.at, laid.alignment)
    }

    /// What was seen on each map.
    pub(super) fn seen_on_maps(&self) -> Vec<Observations> {
        let hypotheses = self.hypotheses.iter();
        hypotheses
            .map(|hypothesis| Observations::of_map(&hypothesis.cell_map))
            .collect()
    }
}
