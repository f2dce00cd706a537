//! `/curve`: the learning curve so far, so that the file of a single episode can show it.

use super::fields::{Fields, fields};
use crate::episode::Episode;

/// The maximum number of points. When it is reached, every second point is dropped.
const MAX_POINTS: usize = 512;

/// Steps and collisions of the episodes so far.
#[derive(Debug, Default)]
pub(in crate::record) struct Curve {
    episode: Vec<u32>,
    steps: Vec<u32>,
    collisions: Vec<u32>,
    /// The number of episodes per point.
    stride: u32,
}

impl Curve {
    /// Returns the message.
    pub fn message(&self) -> Fields {
        fields! { "curve.json":
            episode: self.episode,
            steps: self.steps,
            collisions: self.collisions,
        }
    }

    /// Adds an episode.
    pub fn push(&mut self, episode: &Episode) {
        self.stride = self.stride.max(1);
        if self.episode.len() == MAX_POINTS {
            self.stride *= 2;
            for column in [&mut self.episode, &mut self.steps, &mut self.collisions] {
                let mut at = 0..;
                column.retain(|_| at.next().is_some_and(|i: usize| i.is_multiple_of(2)));
            }
        }
        if (episode.episode.saturating_sub(1)).is_multiple_of(self.stride) {
            self.episode.push(episode.episode);
            self.steps.push(episode.steps);
            self.collisions.push(episode.collisions);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::episode::Ending;

    fn episode(episode: u32) -> Episode {
        Episode {
            episode,
            ending: Ending::Goal,
            steps: 10,
            collisions: 0,
            explored: 0,
            chosen: Default::default(),
            reward: 0.0,
            step_threshold: 50,
            learning_rate: 0.2,
            filter_firings: 0,
            imprinted: false,
            rules: 1,
        }
    }

    #[test]
    fn a_full_curve_keeps_every_second_point() {
        let mut curve = Curve::default();
        // Halved after 512, 1,024 and 2,048 episodes.
        (1..=3000).for_each(|number| curve.push(&episode(number)));
        assert_eq!(curve.episode[..3], [1, 9, 17]);
        assert_eq!(curve.episode.len(), 375);
    }
}
