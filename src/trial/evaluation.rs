//! The greedy policy put to the test.

use serde::{Deserialize, Serialize};

use super::plan::{Plan, PlanError};
use crate::agent::{Explorer, Frozen, Knowledge};
use crate::episode::{self, Ending, Observer};
use crate::streams::StreamName;
use crate::world::{Paths, Starts};
use xcs::random::Stream;

/// Nanoseconds in a second.
const SECOND_NS: f64 = 1e9;

/// What the greedy policy achieved, without learning or exploring.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// The world's name.
    pub world: String,
    /// The arena's name.
    pub arena: String,
    /// The noise level in physics; 0 on the grid.
    pub noise: f64,
    /// The root seed of starts and noise.
    pub seed: u64,
    /// Episodes run.
    pub episodes: u32,
    /// Episodes that reached a goal.
    pub successes: u32,
    /// Episodes that reached a goal in as few steps as possible.
    pub optimal: u32,
    /// Mean steps of an episode.
    pub mean_steps: f64,
    /// Mean steps of an optimal policy from where the episodes started: without slip the length
    /// of the shortest paths.
    pub mean_optimal_steps: f64,
    /// Collisions in all episodes.
    pub collisions: u64,
    /// Mean simulated duration of an episode, in seconds.
    pub mean_seconds: f64,
}

impl Evaluation {
    /// Runs `episodes` episodes (the plan's number is for training) of the greedy policy that
    /// follows from `knowledge`. Ties are broken by chance.
    ///
    /// # Errors
    /// When the plan cannot be run, or the knowledge is that of another world.
    pub fn run(plan: &Plan, knowledge: &Knowledge, episodes: u32) -> Result<Self, PlanError> {
        Self::observed(plan, knowledge, episodes, &mut ())
    }

    /// The same, while somebody watches who may end it after any episode.
    ///
    /// # Errors
    /// The same.
    pub fn observed(
        plan: &Plan,
        knowledge: &Knowledge,
        episodes: u32,
        observer: &mut dyn Observer,
    ) -> Result<Self, PlanError> {
        plan.check()?;
        let Plan { maze, config } = &plan.clone().settled();
        knowledge.check(config.sensor.width(maze), maze.action_count())?;
        let paths = Paths::with_slip(maze, config.settings.arena.slip);
        let mut arena = config.build_arena(maze)?;
        let limit = config.settings.reward.step_threshold;
        let mut policy = Frozen::new(knowledge.clone(), maze.action_count(), limit);
        let mut greedy = Explorer::new(0.0, Stream::new(config.seed, StreamName::Exploration));
        let mut starts = Stream::new(config.seed, StreamName::Start);
        let cells = Starts::new(maze);
        let mut sums = Sums::default();
        for number in 1..=episodes {
            let start = cells
                .nth(maze, starts.below(cells.count()))
                .expect("a checked maze has a start cell");
            let arena = &mut *arena;
            let (episode, flow) = episode::run(
                number,
                start,
                arena,
                config.sensor,
                &mut policy,
                &mut greedy,
                observer,
            );
            sums.add(&episode, paths.distance(maze, start).unwrap_or(0));
            sums.expected += paths.expected_steps(maze, start).unwrap_or(0.0);
            if flow.is_break() {
                break;
            }
        }
        let mean = |sum: u64| sum as f64 / f64::from(episodes.max(1));
        Ok(Self {
            world: maze.name().to_owned(),
            arena: config.arena.name().to_owned(),
            noise: config.noise(),
            seed: config.seed,
            episodes,
            successes: sums.successes,
            optimal: sums.optimal,
            mean_steps: mean(sums.steps),
            mean_optimal_steps: sums.expected / f64::from(episodes.max(1)),
            collisions: sums.collisions,
            mean_seconds: mean(arena.view().now().time_ns) / SECOND_NS,
        })
    }

    /// Did every episode reach a goal in as few steps as possible?
    pub fn is_optimal(&self) -> bool {
        self.optimal == self.episodes
    }
}

/// What adds up over the episodes.
#[derive(Default)]
struct Sums {
    successes: u32,
    optimal: u32,
    steps: u64,
    /// Steps that an optimal policy takes on average.
    expected: f64,
    collisions: u64,
}

impl Sums {
    fn add(&mut self, episode: &episode::Episode, shortest: u32) {
        let success = episode.ending == Ending::Goal;
        self.successes += u32::from(success);
        self.optimal += u32::from(success && episode.steps == shortest);
        self.steps += u64::from(episode.steps);
        self.collisions += u64::from(episode.collisions);
    }
}
