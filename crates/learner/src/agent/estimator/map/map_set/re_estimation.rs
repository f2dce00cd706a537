//! Re-estimation of all maps from the stored episodes.

use crate::agent::estimator::map::association::Alignment;
use crate::agent::estimator::map::hypothesis::MapHypothesis;
use crate::agent::estimator::map::likelihood::Likelihood;
use crate::agent::estimator::map::map_set::{MapSet, Place, climb};
use crate::agent::estimator::map::robot_model::MapStep;

impl MapSet {
    /// Re-estimates all maps from the stored episodes, the shortest first, and once more from the
    /// resulting alignment. Keeps the likelier maps. Looked-up percepts with observation errors use
    /// [their own method](Self::re_estimate_noisily).
    pub(super) fn re_estimate(&mut self) {
        let mut order: Vec<&Vec<MapStep>> = self.episodes.iter().collect();
        order.sort_by_key(|steps| steps.len());
        let order: Vec<Vec<MapStep>> = order.into_iter().cloned().collect();
        if self.has_noisy_percepts() {
            return self.re_estimate_noisily(&order);
        }
        let mut fresh = self.without_episodes();
        for steps in &order {
            fresh.add_episode(steps);
        }
        fresh.update_robot_model();
        let fresh = fresh.re_estimated(&order);
        if fresh.likelihood(&order) > self.likelihood(&order) || order.len() < 25 {
            self.replace_maps(fresh);
        }
        if self.observation_error() > 0.0 {
            self.replace_maps(self.clone().without_redundant(&order));
        }
    }

    /// Replaces the maps and the robot model by re-estimated ones.
    fn replace_maps(&mut self, estimated: Self) {
        self.hypotheses = estimated.hypotheses;
        self.robot = estimated.robot;
        self.slips = estimated.slips;
    }

    /// Re-estimates the maps from the alignment of episodes with the current maps.
    fn re_estimated(&self, episodes: &[Vec<MapStep>]) -> Self {
        let mut again = self.without_episodes();
        let prior = |hypothesis: &MapHypothesis| match hypothesis.transferred {
            Some(number) => self.brought[usize::from(number)].clone(),
            None => MapHypothesis::default(),
        };
        again.hypotheses = self.hypotheses.iter().map(prior).collect();
        for steps in episodes {
            let Some((at, alignment)) = self.best_fit(steps) else {
                continue;
            };
            let hypothesis = &mut again.hypotheses[at];
            let goal = self.robot.vision.of_a_goal();
            hypothesis.cell_map.sight(Place::ORIGIN, goal);
            hypothesis.add(steps, &alignment);
            again.slips[0] += again.slips_of(steps, &alignment);
            again.slips[1] += steps.len() as f64;
        }
        again
            .hypotheses
            .retain(|hypothesis| hypothesis.episodes > 0.0);
        again.update_robot_model();
        again
    }

    /// Removes redundant maps of the same goal. With observation errors, the first episodes may distort a
    /// map so much that later ones open another. A map is redundant if the episodes are as likely without
    /// it, after a penalty of one bit for each of its cells.
    fn without_redundant(self, episodes: &[Vec<MapStep>]) -> Self {
        let maps = |maps: &Self| maps.hypotheses.len();
        climb(self, maps, |maps, at| {
            if maps.hypotheses.len() < 2 {
                return None;
            }
            let fewer = maps.without(at, episodes);
            let cells = maps.hypotheses[at].cell_map.cells();
            (fewer.fit(episodes).doubled(cells) > maps.fit(episodes)).then_some(fewer)
        })
    }

    /// Returns the maps re-estimated without one of them.
    fn without(&self, at: usize, episodes: &[Vec<MapStep>]) -> Self {
        let mut fewer = self.clone();
        fewer.hypotheses.remove(at);
        fewer.re_estimated(episodes).re_estimated(episodes)
    }

    /// Returns the likelihood of episodes on the existing maps.
    fn fit(&self, episodes: &[Vec<MapStep>]) -> Likelihood {
        let fits = episodes.iter().filter_map(|steps| self.best_fit(steps));
        product(fits)
    }

    fn likelihood(&self, episodes: &[Vec<MapStep>]) -> Likelihood {
        product(episodes.iter().map(|steps| self.associate(steps)))
    }
}

/// Returns the likelihood of all episodes, given the alignment of each with a map.
fn product(aligned: impl Iterator<Item = (usize, Alignment)>) -> Likelihood {
    let likelihoods = aligned.map(|(_, alignment)| alignment.likelihood);
    likelihoods.fold(Likelihood::ONE, Likelihood::and)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::agent::estimator::map::place::CellState;
    use crate::agent::estimator::map::{MapParams, Vision};

    /// The maps of a lidar with two transferred ones. The second also has a cell east of its goal.
    fn two_transferred() -> MapSet {
        let mut maps = MapSet::new(8, Vision::Lidar, MapParams::default());
        let goal = Vision::Lidar.of_a_goal();
        maps.brought = [0, 1]
            .map(|number| MapHypothesis::transferred(number, goal))
            .into();
        maps.brought[1]
            .cell_map
            .sight(Place::new(1, 0), CellState::Free);
        maps.hypotheses = maps.brought.clone();
        maps
    }

    #[test]
    fn dropping_one_of_two_transferred_maps_keeps_the_other_one() {
        let maps = two_transferred();
        assert_eq!(maps.without(0, &[]).hypotheses, [maps.brought[1].clone()]);
        assert_eq!(maps.without(1, &[]).hypotheses, [maps.brought[0].clone()]);
        assert_ne!(
            maps.brought[0].cell_map, maps.brought[1].cell_map,
            "control"
        );
    }
}
