//! How many steps the greedy policy takes from all starts.

use serde::{Deserialize, Serialize};

use super::bounds::Bounds;
use super::plan::Plan;
use crate::agent::{Explorer, Frozen, Knowledge};
use crate::arena::{GridArena, SlippingArena};
use crate::episode;
use crate::streams::StreamName;
use xcs::random::Stream;

/// Episodes that a mean is taken over where moves slip.
const RUNS: usize = 500;

/// Steps of the greedy policy with everything frozen, counted on the grid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct GreedySteps {
    /// Mean steps over all starts; an episode that is given up at the step-threshold counts with
    /// that. Where moves slip, over 500 episodes or more, as many from each start.
    pub mean: f64,
    /// Episodes that reached a goal.
    pub arrivals: u32,
    /// All episodes.
    pub episodes: u32,
}

impl GreedySteps {
    /// Runs the greedy policy that follows from `knowledge` from every start. The plan must have been
    /// checked, and the knowledge be that of its world. Ties are broken by chance.
    pub fn of(plan: &Plan, knowledge: &Knowledge) -> Self {
        let Plan { maze, config } = plan;
        let settings = &config.settings;
        let stream = |name| Stream::new(config.seed, name);
        let grid = Box::new(GridArena::new(maze.clone()));
        let mut arena = SlippingArena::new(grid, settings.arena.slip, config.seed);
        let limit = settings.reward.step_threshold;
        let mut policy = Frozen::new(knowledge.clone(), maze.action_count(), limit);
        let mut greedy = Explorer::new(0.0, stream(StreamName::Exploration));
        let starts = maze.start_cells();
        let rounds = match settings.arena.slip > 0.0 {
            true => RUNS.div_ceil(starts.len()),
            false => 1,
        };
        let (mut steps, mut arrivals, mut episodes) = (0_u64, 0, 0);
        for start in (0..rounds).flat_map(|_| &starts) {
            episodes += 1;
            let (episode, _) = episode::run(
                episodes,
                *start,
                &mut arena,
                config.sensor,
                &mut policy,
                &mut greedy,
                &mut (),
            );
            steps += u64::from(episode.steps);
            arrivals += u32::from(episode.ending == episode::Ending::Goal);
        }
        Self {
            mean: steps as f64 / f64::from(episodes.max(1)),
            arrivals,
            episodes,
        }
    }

    /// How many times the steps of the belief bound these are; `None` where moves slip, for which
    /// that is only estimated (`world info --bounds --slip`), or where it is unknown.
    pub fn ratio(&self, plan: &Plan) -> Option<f64> {
        let Plan { maze, config } = plan;
        let exact = config.settings.arena.slip == 0.0;
        let bound = exact
            .then(|| Bounds::of_belief(maze, config.sensor))
            .flatten()?;
        Some(self.mean / bound)
    }
}
