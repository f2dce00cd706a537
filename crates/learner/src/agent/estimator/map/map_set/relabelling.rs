//! Maps, and how all episodes lie on them where cells are misread.

use std::cmp::Reverse;

use crate::agent::estimator::map::association::MapStep;
use crate::agent::estimator::map::hypothesis::MapHypothesis;
use crate::agent::estimator::map::map_set::noisy::{Laid, TO_OPEN};
use crate::agent::estimator::map::map_set::{MapSet, Place};
use crate::agent::estimator::map::observations::Observations;

/// How often episodes are laid anew beside all others, at most.
const SWEEPS: usize = 4;

impl MapSet {
    /// Draws all maps anew: from the maps that there are, and from none, the shortest episodes first.
    pub(super) fn redraw_doubting(&mut self, episodes: &[Vec<MapStep>]) {
        let mut fresh = self.blank();
        for steps in episodes {
            fresh.draw(steps);
        }
        let fresh = Drawing::of(fresh, episodes).improved();
        let old = Drawing::of(self.clone(), episodes).improved();
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

/// Maps, and how all episodes lie on them.
#[derive(Debug, Clone)]
struct Drawing<'a> {
    maps: MapSet,
    episodes: &'a [Vec<MapStep>],
    laid: Vec<Laid>,
}

impl<'a> Drawing<'a> {
    /// These episodes, each where it is likeliest on the maps that there are.
    fn of(maps: MapSet, episodes: &'a [Vec<MapStep>]) -> Self {
        let seen = maps.seen_on_maps();
        let laid = episodes
            .iter()
            .map(|steps| maps.likeliest(steps, &seen, false));
        Self {
            laid: laid.collect(),
            maps,
            episodes,
        }
        .drawn()
    }

    /// Draws the maps from how the episodes lie.
    fn drawn(mut self) -> Self {
        let mut maps = self.maps.blank();
        let hypotheses = self.laid.iter().map(|laid| laid.at + 1).max().unwrap_or(0);
        let hypotheses = hypotheses.max(maps.hypotheses.len());
        maps.hypotheses.resize(hypotheses, MapHypothesis::default());
        let goal = maps.robot.vision.of_a_goal();
        for (steps, laid) in self.episodes.iter().zip(&self.laid) {
            let hypothesis = &mut maps.hypotheses[laid.at];
            hypothesis.add(steps, &laid.alignment);
            hypothesis.cell_map.sight(Place::ORIGIN, goal);
        }
        self.maps = maps;
        self
    }

    /// What is seen on each map.
    fn seen(&self) -> Vec<Observations> {
        let blank = self.maps.blank();
        let mut seen = blank.seen_on_maps();
        seen.resize(self.maps.hypotheses.len(), Observations::default());
        for laid in &self.laid {
            seen[laid.at].add(&laid.seen);
        }
        seen
    }

    /// How likely it is, as a logarithm to the base 2.
    fn bits(&self) -> f64 {
        let observation_error = self.maps.robot().observation_error;
        let seen: f64 = self
            .seen()
            .iter()
            .map(|seen| seen.bits(observation_error))
            .sum();
        let moves: f64 = self.laid.iter().map(|laid| laid.bits).sum();
        seen + moves - TO_OPEN * self.maps.used() as f64
    }

    /// Lays each episode beside all others, until none lies elsewhere.
    fn settled(mut self, may_open: bool) -> Self {
        for _ in 0..SWEEPS {
            let before: Vec<Laid> = self.laid.clone();
            self.sweep(may_open);
            self = self.drawn();
            let stays = |(old, new): (&Laid, &Laid)| {
                old.at == new.at && old.alignment.places == new.alignment.places
            };
            if before.iter().zip(&self.laid).all(stays) {
                break;
            }
        }
        self
    }

    /// Lays each episode once where it is likeliest beside all others.
    fn sweep(&mut self, may_open: bool) {
        let mut seen = self.seen();
        for (steps, laid) in self.episodes.iter().zip(&mut self.laid) {
            seen[laid.at].remove(&laid.seen);
            *laid = self.maps.likeliest(steps, &seen, may_open);
            if laid.at == seen.len() {
                seen.push(Observations::default());
                self.maps.hypotheses.push(MapHypothesis::default());
            }
            seen[laid.at].add(&laid.seen);
            let hypothesis = &mut self.maps.hypotheses[laid.at];
            if hypothesis.episodes == 0.0 {
                hypothesis.add(steps, &laid.alignment);
            }
        }
    }

    /// The same with as many maps as are worth it.
    fn improved(self) -> Self {
        let mut best = self.settled(true).without_needless();
        let mut at = 0;
        while at < best.maps.hypotheses.len() {
            (best, at) = match best.split(at) {
                Some(more) if more.bits() > best.bits() => (more, 0),
                _ => (best, at + 1),
            };
        }
        best
    }

    /// The same with two maps in place of one, on which two goals may have been taken for one; `None` if
    /// there is no room. Each episode is at home among those that lie wrong with it, so to lay one after the
    /// other elsewhere does not lead there.
    fn split(&self, at: usize) -> Option<Self> {
        let new = self.maps.room()?;
        let observation_error = self.maps.robot().observation_error;
        let seen = |number: usize| &self.laid[number].seen;
        let [first, second] = self.most_unlike(at)?;
        let mut halves = [seen(first).clone(), seen(second).clone()];
        let mut split = self.clone();
        split.laid[second].at = new;
        let others = self.laid_on(at).into_iter();
        for number in others.filter(|number| ![first, second].contains(number)) {
            let [old, other] = halves
                .each_ref()
                .map(|half| half.bits_of(seen(number), observation_error));
            halves[usize::from(other > old)].add(seen(number));
            if other > old {
                split.laid[number].at = new;
            }
        }
        Some(split.drawn().settled(false))
    }

    /// The episodes on a map, those that see most first.
    fn laid_on(&self, at: usize) -> Vec<usize> {
        let all = 0..self.laid.len();
        let mut own: Vec<usize> = all.filter(|&number| self.laid[number].at == at).collect();
        own.sort_by_key(|&number| Reverse(self.laid[number].seen.cells()));
        own
    }

    /// Of the episodes on a map the one that sees most, and the one that contradicts it most.
    fn most_unlike(&self, at: usize) -> Option<[usize; 2]> {
        let observation_error = self.maps.robot().observation_error;
        let own = self.laid_on(at);
        let (&first, others) = own.split_first()?;
        let beside = |&number: &usize| {
            let seen = &self.laid[number].seen;
            let gain = self.laid[first].seen.bits_of(seen, observation_error)
                - seen.bits(observation_error);
            (number, gain)
        };
        let worse =
            |worst: (usize, f64), one: (usize, f64)| if one.1 < worst.1 { one } else { worst };
        let (second, _) = others.iter().map(beside).reduce(worse)?;
        Some([first, second])
    }

    /// The same without maps that are not worth it.
    fn without_needless(self) -> Self {
        let mut best = self;
        let mut at = 0;
        while at < best.maps.hypotheses.len() {
            let fewer = best.without(at);
            (best, at) = match fewer {
                Some(fewer) if fewer.bits() > best.bits() => (fewer, 0),
                _ => (best, at + 1),
            };
        }
        best
    }

    fn without(&self, at: usize) -> Option<Self> {
        if self.maps.hypotheses[at].episodes == 0.0 || self.maps.used() < 2 {
            return None;
        }
        let mut maps = self.maps.clone();
        maps.hypotheses[at] = MapHypothesis::default();
        Some(Self::of(maps, self.episodes).settled(false))
    }
}
