//! Evaluation of a learned policy under conditions that it was not trained for.

use std::fmt;

use serde::{Serialize, Serializer};

use super::statistics::{Interval, Proportion};
use crate::agent::Knowledge;
use crate::arena::{ArenaKind, View};
use crate::episode::{Observer, Step};
use crate::trial::{Config, Evaluation, Plan, PlanError};

/// A change to the settings of a run. All other settings stay the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Condition {
    /// No change.
    Unchanged,
    /// `physics.noise`: multiplies the noise of wheels and sensors.
    Noise(u8),
    /// `arena.slip`: the probability that another action is carried out.
    Slip(f64),
    /// `sensor.flip_probability`: the probability that a bit of the percept is flipped.
    Flips(f64),
    /// The friction of the whole floor, in tenths. The robot does not know it.
    FloorFriction(u8),
    /// `physics.faults.dead_sector_deg`: the width of the sector ahead without lidar returns.
    DeadSector(f64),
    /// `physics.faults.stuck_encoder`: the encoder of the left wheel does not count.
    StuckEncoder,
    /// `physics.faults.gyro_drift_radps2`: the drift rate of the gyro's bias.
    GyroDrift(f64),
    /// `physics.faults.dead_bumper`: the front bumper never closes.
    DeadBumper,
}

impl Condition {
    /// All conditions, in the order of the table.
    pub const ALL: [Self; 17] = [
        Self::Unchanged,
        Self::Noise(0),
        Self::Noise(1),
        Self::Noise(2),
        Self::Noise(3),
        Self::Noise(4),
        Self::Noise(5),
        Self::Slip(0.1),
        Self::Slip(0.25),
        Self::Flips(0.01),
        Self::Flips(0.05),
        Self::FloorFriction(5),
        Self::FloorFriction(3),
        Self::DeadSector(90.0),
        Self::StuckEncoder,
        Self::GyroDrift(0.001),
        Self::DeadBumper,
    ];

    /// Returns the reason why the condition does not apply to a run, or `None` if it does.
    fn obstacle(self, config: &Config) -> Option<&'static str> {
        let physics = &config.settings.physics;
        let is_on_grid = config.arena == ArenaKind::Grid;
        match self {
            Self::Unchanged | Self::Slip(_) | Self::Flips(_) => None,
            _ if is_on_grid => Some("the grid has no wheels, floor or sensors"),
            Self::Noise(_) | Self::FloorFriction(_) => None,
            _ if !config.senses() => Some("the robot has access to its true pose"),
            Self::DeadSector(_) if !physics.lidar.fitted => Some("the robot has no lidar"),
            Self::GyroDrift(_) if !physics.gyro.fitted => Some("the robot has no gyro"),
            _ => None,
        }
    }

    /// Returns the plan under this condition. Faults are active from the first episode.
    fn apply(self, mut plan: Plan) -> Plan {
        let settings = &mut plan.config.settings;
        let faults = &mut settings.physics.faults;
        match self {
            Self::Unchanged => return plan,
            Self::Noise(level) => settings.physics.noise = f64::from(level),
            Self::Slip(probability) => settings.arena.slip = probability,
            Self::Flips(probability) => settings.sensor.flip_probability = probability,
            Self::FloorFriction(tenths) => plan.maze = plan.maze.with_friction(tenths),
            Self::DeadSector(degrees) => faults.dead_sector_deg = degrees,
            Self::StuckEncoder => faults.stuck_encoder = true,
            Self::GyroDrift(rate) => faults.gyro_drift_radps2 = rate,
            Self::DeadBumper => faults.dead_bumper = true,
        }
        if self.is_fault() {
            plan.config.settings.physics.faults.from_episode = 1;
        }
        plan
    }

    fn is_fault(self) -> bool {
        matches!(
            self,
            Self::DeadSector(_) | Self::StuckEncoder | Self::GyroDrift(_) | Self::DeadBumper
        )
    }
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unchanged => f.pad("unchanged"),
            Self::Noise(level) => f.pad(&format!("noise {level}")),
            Self::Slip(probability) => f.pad(&format!("slip {probability}")),
            Self::Flips(probability) => f.pad(&format!("flips {probability}")),
            Self::FloorFriction(tenths) => {
                f.pad(&format!("floor friction {}", f64::from(*tenths) / 10.0))
            }
            Self::DeadSector(degrees) => f.pad(&format!("dead sector {degrees} deg")),
            Self::StuckEncoder => f.pad("stuck encoder"),
            Self::GyroDrift(rate) => f.pad(&format!("gyro drift {rate} rad/s2")),
            Self::DeadBumper => f.pad("dead bumper"),
        }
    }
}

impl Serialize for Condition {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// The result of a policy under one condition.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConditionResult {
    /// The condition.
    pub condition: Condition,
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
    /// The condition.
    pub condition: Condition,
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
    pub fn run(plan: &Plan, knowledge: &Knowledge, episodes: u32) -> Result<Self, PlanError> {
        // The step limit must not differ between conditions.
        let plan = plan.clone().settled();
        let mut found = Self {
            world: plan.maze.name().to_owned(),
            arena: plan.config.arena.name(),
            seed: plan.config.seed,
            conditions: Vec::new(),
            left_out: Vec::new(),
        };
        for condition in Condition::ALL {
            match condition.obstacle(&plan.config) {
                Some(reason) => found.left_out.push(LeftOut { condition, reason }),
                None => {
                    let plan = condition.apply(plan.clone());
                    let result = ConditionResult::of(condition, &plan, knowledge, episodes)?;
                    found.conditions.push(result);
                }
            }
        }
        Ok(found)
    }
}

impl ConditionResult {
    fn of(
        condition: Condition,
        plan: &Plan,
        knowledge: &Knowledge,
        episodes: u32,
    ) -> Result<Self, PlanError> {
        let mut mislocalised = Mislocalised::default();
        let evaluation = Evaluation::observed(plan, knowledge, episodes, &mut mislocalised)?;
        let proportion = Proportion {
            successes: evaluation.successes.into(),
            trials: episodes.into(),
        };
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
        let lost = step.view.sensed.is_some_and(|sensed| sensed.lost);
        self.episodes += u32::from(lost && !self.in_this_one);
        self.in_this_one |= lost;
    }
}
