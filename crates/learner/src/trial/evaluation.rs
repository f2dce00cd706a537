//! Evaluation of the greedy policy.

use serde::{Deserialize, Serialize};

use super::Trial;
use super::plan::{Plan, PlanError};
use crate::agent::{Explorer, Knowledge};
use crate::episode::{self, BestChoices, Ending, Observer, Start};
use xcs::random::Stream;
use xcscr_robot::arena::Arena;
use xcscr_robot::streams::StreamName;
use xcscr_robot::world::{Cell, Paths, Starts};

/// Nanoseconds in a second.
const SECOND_NS: f64 = 1e9;

/// The results of the greedy policy, without learning or exploring.
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
    /// Episodes that reached a goal in the minimum number of steps. If actions slip, episodes that
    /// reached a goal with only best actions.
    pub optimal: u32,
    /// Mean steps of an episode.
    pub mean_steps: f64,
    /// Mean steps of an optimal policy from the starts of the episodes. Without slip, the length of
    /// the shortest paths.
    pub mean_optimal_steps: f64,
    /// Collisions in all episodes.
    pub collisions: u64,
    /// Mean simulated duration of an episode, in seconds.
    pub mean_seconds: f64,
    /// The centre of the start cell in the map frame, in metres; `None` if episodes start anywhere.
    #[serde(default)]
    pub start_m: Option<[f64; 2]>,
    /// The centres of the goal cells in the map frame, in metres.
    #[serde(default)]
    pub goals_m: Vec<[f64; 2]>,
}

impl Evaluation {
    /// Runs `episodes` episodes of the greedy policy of `knowledge`; the plan's number of episodes
    /// is ignored. Ties are broken at random.
    ///
    /// # Errors
    /// When the plan cannot be run, or the knowledge is from another world.
    pub fn run(plan: &Plan, knowledge: &Knowledge, episodes: u32) -> Result<Self, PlanError> {
        Self::observed(plan, knowledge, episodes, &mut ())
    }

    /// Like [`run`](Self::run), with an observer that may end the evaluation after any episode.
    ///
    /// # Errors
    /// The same as for [`run`](Self::run).
    pub fn observed(
        plan: &Plan,
        knowledge: &Knowledge,
        episodes: u32,
        observer: &mut dyn Observer,
    ) -> Result<Self, PlanError> {
        plan.check()?;
        let mut arena = plan.config.build_arena(&plan.maze)?;
        Self::in_arena(plan, &mut *arena, knowledge, episodes, observer)
    }

    /// Runs `episodes` episodes with the robot of the trial, in the state that the trial left it
    /// in, including its faults.
    ///
    /// # Errors
    /// When the knowledge does not fit the trial's plan.
    pub fn after(trial: &mut Trial, episodes: u32) -> Result<Self, PlanError> {
        let knowledge = trial.method().knowledge();
        let (plan, arena) = (&trial.plan, &mut *trial.arena);
        Self::in_arena(plan, arena, &knowledge, episodes, &mut ())
    }

    fn in_arena(
        plan: &Plan,
        arena: &mut dyn Arena,
        knowledge: &Knowledge,
        episodes: u32,
        observer: &mut dyn Observer,
    ) -> Result<Self, PlanError> {
        let plan = plan.clone().settled();
        let Plan { maze, config } = &plan;
        knowledge.check(config.perception(), maze)?;
        let began_ns = arena.view().now().time_ns;
        let mut starts = Stream::new(config.seed, StreamName::Start);
        let cells = Starts::new(maze);
        let starts = (0..episodes).map(|_| {
            let start = cells.nth(maze, starts.below(cells.count()));
            start.expect("a checked maze has a start cell")
        });
        let sums = GreedySums::over(starts, &plan, arena, knowledge, observer);
        // The observer may have ended the evaluation early.
        let episodes = sums.episodes;
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
            mean_seconds: mean(arena.view().now().time_ns - began_ns) / SECOND_NS,
            start_m: maze.start().map(|cell| maze.centre_m(cell).into()),
            goals_m: maze
                .goals()
                .iter()
                .map(|&cell| maze.centre_m(cell).into())
                .collect(),
        })
    }

    /// Returns true if every episode was [optimal](Self::optimal).
    pub fn is_optimal(&self) -> bool {
        self.optimal == self.episodes
    }
}

/// Sums over the episodes of a greedy policy.
#[derive(Default)]
pub(super) struct GreedySums {
    pub episodes: u32,
    pub successes: u32,
    optimal: u32,
    pub steps: u64,
    /// Expected steps of an optimal policy.
    expected: f64,
    collisions: u64,
}

impl GreedySums {
    /// Runs one episode of a settled plan from each start, until the observer ends them. Ties are broken at random.
    pub fn over(
        starts: impl Iterator<Item = Cell>,
        Plan { maze, config }: &Plan,
        arena: &mut dyn Arena,
        knowledge: &Knowledge,
        observer: &mut dyn Observer,
    ) -> Self {
        let mut policy = config.policy(knowledge.clone(), maze);
        let paths = Paths::with_slip(maze, config.settings.arena.slip);
        let mut greedy = Explorer::new(0.0, Stream::new(config.seed, StreamName::Exploration));
        let mut sums = Self::default();
        for (episode, cell) in (1..).zip(starts) {
            let mut choices = BestChoices::by(&paths);
            let start = Start {
                episode,
                cell,
                evolves: false,
            };
            let (episode, flow) = episode::run(
                start,
                arena,
                config.sensor,
                &mut *policy,
                &mut greedy,
                &mut (&mut choices, &mut *observer),
            );
            sums.add(&episode, choices.is_optimal(&episode));
            sums.expected += paths.expected_steps(maze, cell).unwrap_or(0.0);
            if flow.is_break() {
                break;
            }
        }
        sums
    }

    fn add(&mut self, episode: &episode::Episode, was_optimal: bool) {
        let success = episode.ending == Ending::Goal;
        self.episodes += 1;
        self.successes += u32::from(success);
        self.optimal += u32::from(was_optimal);
        self.steps += u64::from(episode.steps);
        self.collisions += u64::from(episode.collisions);
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::agent::Frozen;
    use xcs::Action;
    use xcscr_robot::arena::{ArenaKind, FaultParams, Localisation};
    use xcscr_robot::sensor::Sensor;
    use xcscr_robot::world::Maze;

    /// Ends an evaluation after its third episode.
    struct UpToThree;

    impl Observer for UpToThree {
        fn ended(
            &mut self,
            episode: &episode::Episode,
            _: &episode::AfterEpisode<'_>,
        ) -> ControlFlow<()> {
            match episode.episode < 3 {
                true => ControlFlow::Continue(()),
                false => ControlFlow::Break(()),
            }
        }
    }

    #[test]
    fn means_are_those_of_the_episodes_that_were_run() {
        let maze = Maze::load("../../worlds/maze4.json".as_ref()).unwrap();
        let mut plan = Plan::new(maze)
            .arena(ArenaKind::Grid)
            .sensor(Sensor::Position);
        // There are no values, so every episode takes the maximum number of steps.
        plan.config.settings.reward.step_threshold = 9;
        plan.config.settings.reward.step_threshold_from_maze = false;
        let knowledge = Knowledge::Table(std::collections::BTreeMap::new());
        let whole = Evaluation::run(&plan, &knowledge, 3).unwrap();
        let ended = Evaluation::observed(&plan, &knowledge, 200, &mut UpToThree).unwrap();
        assert_eq!(ended, whole);
        assert_eq!((ended.episodes, ended.successes), (3, 0));
    }

    /// Evaluates a policy by position in Maze4 with slipping actions: the policy of value
    /// iteration, with the opposite choices in `other` cells.
    fn evaluated(other: impl Fn(Cell) -> bool) -> Evaluation {
        let maze = Maze::load("../../worlds/maze4.json".as_ref()).unwrap();
        let plan = Plan::new(maze)
            .arena(ArenaKind::Grid)
            .sensor(Sensor::Position);
        let mut plan = plan.seed(3);
        plan.config.settings.arena.slip = 0.25;
        plan.config.settings.reward.step_threshold = 1_000;
        let maze = &plan.maze;
        let paths = Paths::with_slip(maze, 0.25);
        let row = |cell: Cell| {
            let is_best = |action| paths.successor(maze, cell, action).is_some();
            let values = |action| Some(f64::from(u8::from(is_best(action) != other(cell))));
            Action::all(4).map(values).collect()
        };
        let cells = maze.free_cells();
        let table = cells.map(|cell| (Sensor::Position.perceive_at(maze, cell), row(cell)));
        let knowledge = Knowledge::Table(table.collect());
        Evaluation::run(&plan, &knowledge, 200).unwrap()
    }

    #[test]
    fn with_slip_an_episode_is_optimal_if_all_choices_were_and_not_if_it_was_short() {
        let best = evaluated(|_| false);
        assert!(best.is_optimal() && best.successes == 200, "{best:?}");
        assert!(best.mean_steps > 12.0, "luck alone makes 10: {best:?}");
        let expected = best.mean_optimal_steps;
        assert!((best.mean_steps / expected - 1.0).abs() < 0.1, "{best:?}");
    }

    #[test]
    fn control_one_wrong_choice_makes_an_episode_not_optimal() {
        // The cell south-east of the start, on every path.
        let wrong = evaluated(|cell| (cell.col, cell.row) == (2, 2));
        assert!(wrong.optimal < wrong.successes, "{wrong:?}");
    }

    /// Runs a trial of two episodes in Maze4, with a robot without noise that localises itself, and
    /// a fixed policy. All sensors break in `from_episode`.
    fn sensed_trial(from_episode: u32) -> Trial {
        let maze = Maze::load("../../worlds/maze4.json".as_ref()).unwrap();
        let (paths, sensor) = (Paths::with_slip(&maze, 0.0), Sensor::LidarPosition);
        let row = |cell: Cell| {
            let is_best = |action| paths.successor(&maze, cell, action).is_some();
            let values = |action| Some(f64::from(u8::from(is_best(action))));
            Action::all(4).map(values).collect()
        };
        let cells = maze.free_cells();
        let table = cells.map(|cell| (sensor.perceive_at(&maze, cell), row(cell)));
        let knowledge = Knowledge::Table(table.collect());
        let mut plan = Plan::new(maze).sensor(sensor).episodes(2);
        let physics = &mut plan.config.settings.physics;
        physics.localisation = Localisation::Estimated;
        physics.noise = 0.0;
        physics.faults = FaultParams {
            from_episode,
            dead_sector_deg: 360.0,
            stuck_encoder: true,
            gyro_drift_radps2: 0.001,
            dead_bumper: true,
        };
        plan.config.settings.reward.step_threshold = 30;
        let mut trial = Trial::with_agent(plan, Box::new(Frozen::new(knowledge, 4, 30))).unwrap();
        assert!(trial.run(&mut ()).is_continue());
        trial
    }

    #[test]
    fn sensors_that_broke_in_the_training_are_still_broken_when_it_is_evaluated() {
        let [mut broken, mut sound] = [2, 9].map(sensed_trial);
        let [after, control] =
            [&mut broken, &mut sound].map(|trial| Evaluation::after(trial, 1).unwrap());
        assert_eq!(after.successes, 0, "{after:?}");
        assert!(control.is_optimal(), "control: {control:?}");
        let knowledge = broken.method().knowledge();
        let new = Evaluation::run(broken.plan(), &knowledge, 1).unwrap();
        assert!(new.is_optimal(), "control, a new robot: {new:?}");
    }
}
