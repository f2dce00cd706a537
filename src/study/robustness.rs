//! Evaluation of a learned policy under conditions that it was not trained for.

use serde::Serialize;

use super::statistics::{Interval, Proportion};
use crate::Error;
use crate::agent::{Frozen, Knowledge};
use crate::arena::{ArenaKind, FaultParams, View};
use crate::episode::{Observer, PolicyMap, Step};
use crate::run;
use crate::trial::{Config, Plan};

/// The side in metres of the box on the route.
const BOX_M: f64 = 0.4;
/// The condition with the box. It exists only in worlds from maps.
const WITH_BOX: &str = "one box on the route";

/// What a condition requires of a run.
#[derive(Debug, Clone, Copy)]
enum Needs {
    Nothing,
    Physics,
    Sensing,
    Lidar,
    Gyro,
}

/// A change to the settings of a run. All other settings stay the same.
struct Condition {
    name: &'static str,
    needs: Needs,
    change: fn(&mut Plan),
}

/// All conditions, in the order of the table. The robot does not know the friction of the floor.
const CONDITIONS: [Condition; 17] = [
    Condition::new("unchanged", Needs::Nothing, |_| ()),
    Condition::new("noise 0", Needs::Physics, |plan| set_noise(plan, 0.0)),
    Condition::new("noise 1", Needs::Physics, |plan| set_noise(plan, 1.0)),
    Condition::new("noise 2", Needs::Physics, |plan| set_noise(plan, 2.0)),
    Condition::new("noise 3", Needs::Physics, |plan| set_noise(plan, 3.0)),
    Condition::new("noise 4", Needs::Physics, |plan| set_noise(plan, 4.0)),
    Condition::new("noise 5", Needs::Physics, |plan| set_noise(plan, 5.0)),
    Condition::new("slip 0.1", Needs::Nothing, |plan| set_slip(plan, 0.1)),
    Condition::new("slip 0.25", Needs::Nothing, |plan| set_slip(plan, 0.25)),
    Condition::new("flips 0.01", Needs::Nothing, |plan| set_flips(plan, 0.01)),
    Condition::new("flips 0.05", Needs::Nothing, |plan| set_flips(plan, 0.05)),
    Condition::new("floor friction 0.5", Needs::Physics, |plan| {
        plan.maze = plan.maze.with_friction(5);
    }),
    Condition::new("floor friction 0.3", Needs::Physics, |plan| {
        plan.maze = plan.maze.with_friction(3);
    }),
    Condition::new("dead sector 90 deg", Needs::Lidar, |plan| {
        faults(plan).dead_sector_deg = 90.0;
    }),
    Condition::new("stuck encoder", Needs::Sensing, |plan| {
        faults(plan).stuck_encoder = true;
    }),
    Condition::new("gyro drift 0.001 rad/s2", Needs::Gyro, |plan| {
        faults(plan).gyro_drift_radps2 = 0.001;
    }),
    Condition::new("dead bumper", Needs::Sensing, |plan| {
        faults(plan).dead_bumper = true;
    }),
];

fn set_noise(plan: &mut Plan, level: f64) {
    plan.config.settings.physics.noise = level;
}

fn set_slip(plan: &mut Plan, probability: f64) {
    plan.config.settings.arena.slip = probability;
}

fn set_flips(plan: &mut Plan, probability: f64) {
    plan.config.settings.sensor.flip_probability = probability;
}

/// Returns the faults, which are present from the first episode.
fn faults(plan: &mut Plan) -> &mut FaultParams {
    let faults = &mut plan.config.settings.physics.faults;
    faults.from_episode = 1;
    faults
}

impl Condition {
    const fn new(name: &'static str, needs: Needs, change: fn(&mut Plan)) -> Self {
        Self {
            name,
            needs,
            change,
        }
    }

    /// Returns the reason why the condition does not apply to a run, or `None` if it does.
    fn obstacle(&self, config: &Config) -> Option<&'static str> {
        let physics = &config.settings.physics;
        let is_on_grid = config.arena == ArenaKind::Grid;
        match self.needs {
            Needs::Nothing => None,
            _ if is_on_grid => Some("the grid has no wheels, floor or sensors"),
            Needs::Physics => None,
            _ if !config.senses() => Some("the robot has access to its true pose"),
            Needs::Lidar if !physics.lidar.fitted => Some("the robot has no lidar"),
            Needs::Gyro if !physics.gyro.fitted => Some("the robot has no gyro"),
            _ => None,
        }
    }
}

/// The result of a policy under one condition.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConditionResult {
    /// The name of the condition.
    pub condition: &'static str,
    /// Number of episodes.
    pub episodes: u32,
    /// Number of episodes that reached a goal.
    pub successes: u32,
    /// The share of successes, with Wilson's 95 % interval.
    pub success: Interval,
    /// Mean number of steps per episode.
    pub mean_steps: f64,
    /// Mean number of collisions per episode.
    pub collisions_per_episode: f64,
    /// Episodes in which the robot was mislocalised after at least one step: the estimated pose was
    /// in another cell than the true pose. `None` for a robot that does not estimate its pose.
    pub mislocalised_episodes: Option<u32>,
}

/// A condition that does not apply to a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LeftOut {
    /// The name of the condition.
    pub condition: &'static str,
    /// The reason.
    pub reason: &'static str,
}

/// The results of a policy under all conditions, from the same seed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Robustness {
    /// The world's name.
    pub world: String,
    /// The arena's name.
    pub arena: &'static str,
    /// The root seed of starts and noise, the same for each condition.
    pub seed: u64,
    /// The conditions that apply.
    pub conditions: Vec<ConditionResult>,
    /// The conditions that do not apply.
    pub left_out: Vec<LeftOut>,
}

impl Robustness {
    /// Runs `episodes` episodes of the greedy policy under each condition that applies.
    ///
    /// # Errors
    /// When the plan cannot be run, or the knowledge does not fit the plan.
    /// [`ErrorKind::Interrupted`](crate::ErrorKind::Interrupted) if `stop` returned true after an
    /// episode.
    pub fn run(
        plan: &Plan,
        knowledge: &Knowledge,
        episodes: u32,
        stop: &dyn Fn() -> bool,
    ) -> Result<Self, Error> {
        // The step limit must not differ between conditions.
        let plan = plan.clone().settled();
        let mut found = Self {
            world: plan.maze.name().to_owned(),
            arena: plan.config.arena.name(),
            seed: plan.config.seed,
            conditions: Vec::new(),
            left_out: Vec::new(),
        };
        for condition in CONDITIONS {
            match condition.obstacle(&plan.config) {
                Some(reason) => found.left_out.push(LeftOut {
                    condition: condition.name,
                    reason,
                }),
                None => {
                    let mut changed = plan.clone();
                    (condition.change)(&mut changed);
                    let name = condition.name;
                    let result = ConditionResult::of(name, &changed, knowledge, episodes, stop)?;
                    found.conditions.push(result);
                }
            }
        }
        if plan.maze.is_from_map() && plan.config.arena == ArenaKind::Physics {
            found.add_box(&plan, knowledge, episodes, stop)?;
        }
        Ok(found)
    }

    /// Adds the condition with a box that is not in the map of the robot.
    fn add_box(
        &mut self,
        plan: &Plan,
        knowledge: &Knowledge,
        episodes: u32,
        stop: &dyn Fn() -> bool,
    ) -> Result<(), Error> {
        let reason = match plan.maze.start() {
            None => "the world has no start cell, so there is no route",
            Some(_) => match with_box(plan, knowledge) {
                Some(plan) => {
                    let result = ConditionResult::of(WITH_BOX, &plan, knowledge, episodes, stop)?;
                    self.conditions.push(result);
                    return Ok(());
                }
                None => "no box on the route leaves another way",
            },
        };
        self.left_out.push(LeftOut {
            condition: WITH_BOX,
            reason,
        });
        Ok(())
    }
}

/// Returns the plan with a box in the middle of the way that the policy takes from the start, or as
/// near to the middle as it leaves another way.
fn with_box(plan: &Plan, knowledge: &Knowledge) -> Option<Plan> {
    let Plan { maze, config } = plan;
    let policy = Frozen::new(knowledge.clone(), maze.action_count(), 1);
    let policy = PolicyMap::of(&policy, config.sensor, maze);
    let route = policy.greedy_path(maze, maze.start()?);
    let mut places: Vec<usize> = (0..route.len()).collect();
    places.sort_by_key(|at| at.abs_diff(route.len() / 2));
    let boxed = places
        .into_iter()
        .find_map(|at| maze.with_box(route[at], BOX_M));
    boxed.map(|maze| Plan {
        maze,
        config: config.clone(),
    })
}

impl ConditionResult {
    fn of(
        condition: &'static str,
        plan: &Plan,
        knowledge: &Knowledge,
        episodes: u32,
        stop: &dyn Fn() -> bool,
    ) -> Result<Self, Error> {
        let mut mislocalised = Mislocalised::default();
        let evaluation = run::observe(plan, knowledge, episodes, &mut mislocalised, stop)?;
        let proportion = Proportion::new(evaluation.successes.into(), episodes.into());
        Ok(Self {
            condition,
            episodes,
            successes: evaluation.successes,
            success: proportion.wilson(),
            mean_steps: evaluation.mean_steps,
            collisions_per_episode: evaluation.collisions as f64 / f64::from(episodes.max(1)),
            mislocalised_episodes: plan.config.senses().then_some(mislocalised.episodes),
        })
    }
}

/// Counts the episodes in which the robot was mislocalised.
#[derive(Default)]
struct Mislocalised {
    episodes: u32,
    in_this_one: bool,
}

impl Observer for Mislocalised {
    fn began(&mut self, _: u32, _: &View<'_>) {
        self.in_this_one = false;
    }

    fn stepped(&mut self, step: &Step<'_>) {
        let lost = step.view.sensed.is_some_and(|sensed| sensed.mislocalised);
        self.episodes += u32::from(lost && !self.in_this_one);
        self.in_this_one |= lost;
    }
}
