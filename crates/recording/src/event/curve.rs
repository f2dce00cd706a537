//! `/curve`: the learning curve so far, so that the file of a single episode can show it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::End;

/// The maximum number of points. When it is reached, every second point is dropped.
const MAX_POINTS: usize = 512;

/// Steps and collisions of the episodes so far.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Curve {
    /// Numbers of the episodes so far; long runs have a sample.
    pub episode: Vec<u32>,
    /// Steps of each episode.
    pub steps: Vec<u32>,
    /// Collisions of each episode.
    pub collisions: Vec<u32>,
    /// The number of episodes per point.
    #[serde(skip)]
    stride: u32,
}

impl Curve {
    /// Adds an episode.
    pub fn push(&mut self, episode: &End) {
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

    fn episode(episode: u32) -> End {
        End {
            episode,
            outcome: "goal".to_owned(),
            steps: 10,
            collisions: 0,
            explored: 0,
            reward: 0.0,
            rules: 1,
            micro: None,
            generality: None,
            mean_error: None,
            step_threshold: 50,
            learning_rate: 0.2,
            imprinted: false,
            optimal: false,
            greedy_steps: None,
            shortest: None,
            start_values: Vec::new(),
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
