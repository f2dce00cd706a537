//! Joint re-estimation of maps and their episodes under observation noise.

use std::cmp::Reverse;

use crate::agent::estimator::map::hypothesis::MapHypothesis;
use crate::agent::estimator::map::map_set::noisy::{Assignment, OPENING_COST};
use crate::agent::estimator::map::map_set::{MapSet, Place, climb};
use crate::agent::estimator::map::observations::Observations;
use crate::agent::estimator::map::robot_model::MapStep;

/// The maximum number of passes that reassign episodes.
const SWEEPS: usize = 4;

impl MapSet {
    /// Re-estimates all maps, from the current maps and from none. The shortest episodes come first.
    pub(super) fn re_estimate_noisily(&mut self, episodes: &[Vec<MapStep>]) {
        let mut fresh = self.without_episodes();
        for steps in episodes {
            fresh.add_episode(steps);
        }
        let fresh = Labelling::of(fresh, episodes).improved();
        let old = Labelling::of(self.clone(), episodes).improved();
        let best = if fresh.bits() > old.bits() {
            fresh
        } else {
            old
        };
        let mut maps = best.maps;
        maps.hypotheses
            .retain(|hypothesis| hypothesis.episodes > 0.0);
        self.hypotheses = maps.hypotheses;
    }
}

/// Maps and the assignment of all episodes to them.
#[derive(Debug, Clone)]
struct Labelling<'a> {
    maps: MapSet,
    episodes: &'a [Vec<MapStep>],
    assigned: Vec<Assignment>,
}

impl<'a> Labelling<'a> {
    /// Assigns each episode to the likeliest existing map.
    fn of(maps: MapSet, episodes: &'a [Vec<MapStep>]) -> Self {
        let seen = maps.seen_on_maps();
        let assigned = episodes
            .iter()
            .map(|steps| maps.likeliest(steps, &seen, false));
        Self {
            assigned: assigned.collect(),
            maps,
            episodes,
        }
        .re_estimated()
    }

    /// Re-estimates the maps from the assigned episodes.
    fn re_estimated(mut self) -> Self {
        let mut maps = self.maps.without_episodes();
        let hypotheses = self
            .assigned
            .iter()
            .map(|assigned| assigned.at + 1)
            .max()
            .unwrap_or(0);
        let hypotheses = hypotheses.max(maps.hypotheses.len());
        maps.hypotheses.resize(hypotheses, MapHypothesis::default());
        let goal = maps.robot.vision.of_a_goal();
        for (steps, assigned) in self.episodes.iter().zip(&self.assigned) {
            let hypothesis = &mut maps.hypotheses[assigned.at];
            hypothesis.add(steps, &assigned.alignment);
            hypothesis.cell_map.sight(Place::ORIGIN, goal);
        }
        self.maps = maps;
        self
    }

    /// Returns the observations on each map.
    fn seen(&self) -> Vec<Observations> {
        let empty = self.maps.without_episodes();
        let mut seen = empty.seen_on_maps();
        seen.resize(self.maps.hypotheses.len(), Observations::default());
        for assigned in &self.assigned {
            seen[assigned.at].add(&assigned.seen);
        }
        seen
    }

    /// Returns the log2 likelihood of the assignment.
    fn bits(&self) -> f64 {
        let observation_error = self.maps.robot().observation_error;
        let seen: f64 = self
            .seen()
            .iter()
            .map(|seen| seen.bits(observation_error))
            .sum();
        let moves: f64 = self.assigned.iter().map(|assigned| assigned.bits).sum();
        seen + moves - OPENING_COST * self.maps.used() as f64
    }

    /// Reassigns each episode, given all others, until no assignment changes.
    fn converged(mut self, may_open: bool) -> Self {
        for _ in 0..SWEEPS {
            let before: Vec<Assignment> = self.assigned.clone();
            self.sweep(may_open);
            self = self.re_estimated();
            let stays = |(old, new): (&Assignment, &Assignment)| {
                old.at == new.at && old.alignment.places == new.alignment.places
            };
            if before.iter().zip(&self.assigned).all(stays) {
                break;
            }
        }
        self
    }

    /// Reassigns each episode once to the map on which it is likeliest, given all others.
    fn sweep(&mut self, may_open: bool) {
        let mut seen = self.seen();
        for (steps, assigned) in self.episodes.iter().zip(&mut self.assigned) {
            seen[assigned.at].remove(&assigned.seen);
            *assigned = self.maps.likeliest(steps, &seen, may_open);
            if assigned.at == seen.len() {
                seen.push(Observations::default());
                self.maps.hypotheses.push(MapHypothesis::default());
            }
            seen[assigned.at].add(&assigned.seen);
            let hypothesis = &mut self.maps.hypotheses[assigned.at];
            if hypothesis.episodes == 0.0 {
                hypothesis.add(steps, &assigned.alignment);
            }
        }
    }

    /// Optimises the number of maps.
    fn improved(self) -> Self {
        let best = self.converged(true).without_redundant();
        climb(best, Self::hypotheses, |best, at| {
            best.split(at).filter(|more| more.bits() > best.bits())
        })
    }

    fn hypotheses(&self) -> usize {
        self.maps.hypotheses.len()
    }

    /// Splits a map that may combine two goals; `None` if no further map is allowed. Single reassignments
    /// cannot separate the goals, because each episode fits the others that are wrongly on the same map.
    fn split(&self, at: usize) -> Option<Self> {
        let new = self.maps.room()?;
        let observation_error = self.maps.robot().observation_error;
        let seen = |number: usize| &self.assigned[number].seen;
        let [first, second] = self.most_unlike(at)?;
        let mut halves = [seen(first).clone(), seen(second).clone()];
        let mut split = self.clone();
        split.assigned[second].at = new;
        let others = self.assigned_to(at).into_iter();
        for number in others.filter(|number| ![first, second].contains(number)) {
            let [old, other] = halves
                .each_ref()
                .map(|half| half.bits_of(seen(number), observation_error));
            halves[usize::from(other > old)].add(seen(number));
            if other > old {
                split.assigned[number].at = new;
            }
        }
        Some(split.re_estimated().converged(false))
    }

    /// Returns the episodes on a map, the ones with the most observed cells first.
    fn assigned_to(&self, at: usize) -> Vec<usize> {
        let all = 0..self.assigned.len();
        let mut own: Vec<usize> = all
            .filter(|&number| self.assigned[number].at == at)
            .collect();
        own.sort_by_key(|&number| Reverse(self.assigned[number].seen.cells()));
        own
    }

    /// Returns the episode on a map with the most observed cells, and the one that contradicts it most.
    fn most_unlike(&self, at: usize) -> Option<[usize; 2]> {
        let observation_error = self.maps.robot().observation_error;
        let own = self.assigned_to(at);
        let (&first, others) = own.split_first()?;
        let beside = |&number: &usize| {
            let seen = &self.assigned[number].seen;
            let gain = self.assigned[first].seen.bits_of(seen, observation_error)
                - seen.bits(observation_error);
            (number, gain)
        };
        let worse =
            |worst: (usize, f64), one: (usize, f64)| if one.1 < worst.1 { one } else { worst };
        let (second, _) = others.iter().map(beside).reduce(worse)?;
        Some([first, second])
    }

    /// Removes maps that do not increase the likelihood.
    fn without_redundant(self) -> Self {
        climb(self, Self::hypotheses, |best, at| {
            best.without(at).filter(|fewer| fewer.bits() > best.bits())
        })
    }

    fn without(&self, at: usize) -> Option<Self> {
        if self.maps.hypotheses[at].episodes == 0.0 || self.maps.used() < 2 {
            return None;
        }
        let mut maps = self.maps.clone();
        maps.hypotheses[at] = MapHypothesis::default();
        Some(Self::of(maps, self.episodes).converged(false))
    }
}
