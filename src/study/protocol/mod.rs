//! The protocol of a study, which is fixed before its first trial.

mod differences;
mod file;
mod freeze;
mod keys;
mod shipped;
mod variants;

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::value::RawValue;

pub(super) use differences::distinct;
pub(super) use file::NOTHING;
pub use file::StudyFile;
pub use keys::StudyKey;

use crate::Error;
use crate::agent::Method;
use crate::arena::ArenaKind;
use crate::sensor::Sensor;
use crate::study::custom::Agents;
use crate::trial::{Config, Plan, Settings};
use crate::world::Maze;
use xcs::bounds::{OutOfRange, within};
use xcs::random::replicate_seed;

/// Maximum number of arms. More would fill the memory with settings before the first trial.
const MOST_ARMS: usize = 2_500;
/// Maximum number of worlds, and of cells in all generated worlds. A short name can generate a
/// large world.
const MOST_WORLDS: usize = 1_000;
const MOST_GENERATED: usize = 1 << 22;
/// More tasks than any cluster engine accepts at once.
const MOST_TASKS: usize = 100_000;
/// Maximum number of trials. The missing trials are kept as a list.
const MOST_TRIALS: usize = 4_000_000;

/// The values that a variant sets, by the full names of the settings.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Variant(pub BTreeMap<String, serde_json::Value>);

impl fmt::Display for Variant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, (key, value)) in self.0.iter().enumerate() {
            let gap = if i == 0 { "" } else { " " };
            match value.as_str() {
                Some(text) => write!(f, "{gap}{key}={text}")?,
                None => write!(f, "{gap}{key}={value}")?,
            }
        }
        Ok(())
    }
}

/// One combination of everything that a study varies except the seed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Arm {
    /// The world's name.
    pub world: String,
    /// The learning method.
    pub method: Method,
    /// The arena.
    pub arena: ArenaKind,
    /// The sensor.
    pub sensor: Sensor,
    /// The settings of the variant.
    pub variant: Variant,
    /// All settings, including those of the variant.
    pub settings: Settings,
    /// The name of a custom agent, which replaces the method.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub agent: Option<String>,
}

impl Arm {
    /// Returns the name of the method, or of the custom agent.
    pub fn method_name(&self) -> &str {
        self.agent.as_deref().unwrap_or(self.method.name())
    }

    /// Returns the world, the method, the arena, the sensor and the variant in words.
    pub fn name(&self) -> String {
        let words = [self.method_name(), self.arena.name(), self.sensor.name()];
        let name = format!("{} {} {}", self.world, words.join(" "), self.variant);
        name.trim_end().to_owned()
    }
}

/// A study with all settings resolved. It determines the plan of each trial.
///
/// Trials are numbered consecutively: all trials of the first arm, then all of the second, and so
/// on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Protocol {
    /// The version of this program. Another version may give other results.
    pub version: String,
    /// The study's name.
    pub name: String,
    /// Root seed of all trials.
    pub seed: u64,
    /// Trials per arm.
    pub trials: usize,
    /// Episodes per trial.
    pub episodes: u32,
    /// Episodes in which the greedy policy of each finished trial drives the trial's own robot,
    /// without learning or exploration. 0 for none.
    #[serde(default, skip_serializing_if = "is_none")]
    pub drives: u32,
    /// The method that reports compare with each other one, if one is chosen.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference: Option<String>,
    /// The worlds, which have unique names.
    #[serde(serialize_with = "write_mazes", deserialize_with = "read_mazes")]
    pub worlds: Vec<Maze>,
    /// The arms that are compared.
    pub arms: Vec<Arm>,
}

impl Protocol {
    /// Freezes a study file, with custom agents in addition to its methods.
    ///
    /// # Errors
    /// When a world, a setting or a number is invalid.
    pub fn new(file: &StudyFile, agents: &Agents) -> Result<Self, Error> {
        freeze::freeze(file, agents)
    }

    /// Returns the id of the study: a checksum of everything in the protocol.
    pub fn id(&self) -> String {
        id_of(&self.to_json())
    }

    /// Returns the id of each arm: its name, and a checksum of everything that determines its trials. An arm has the same
    /// id in a larger study.
    pub(super) fn arm_ids(&self) -> Vec<String> {
        let id = |(at, arm): (usize, &Arm)| {
            let numbers = (&self.version, self.seed, self.episodes, self.drives);
            let json = serde_json::to_string(&(numbers, arm)).expect("plain data becomes JSON");
            let world = self.maze(at * self.trials).to_json();
            format!("{} {}", arm.name(), id_of(&(json + &world)))
        };
        self.arms.iter().enumerate().map(id).collect()
    }

    /// Checks that the study can be split into this many tasks.
    ///
    /// # Errors
    /// When there are more tasks than trials.
    pub fn check_tasks(&self, tasks: usize) -> Result<(), Error> {
        Ok(within("tasks", tasks, 1..=MOST_TASKS.min(self.len()))?)
    }

    /// Returns the protocol as a JSON document.
    pub(super) fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).expect("plain data becomes JSON")
    }

    /// Returns the number of all trials.
    pub fn len(&self) -> usize {
        self.arms.len() * self.trials
    }

    /// Returns true if there are no trials.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the arm of a trial.
    pub fn arm(&self, trial: usize) -> &Arm {
        &self.arms[trial / self.trials]
    }

    /// Returns the number of a trial within its arm, counted from 1.
    pub fn replicate(&self, trial: usize) -> usize {
        trial % self.trials + 1
    }

    /// Returns the seed of a trial. It is the same for the same replicate of every arm, so that
    /// comparisons are paired.
    pub fn trial_seed(&self, trial: usize) -> u64 {
        replicate_seed(self.seed, self.replicate(trial) as u64)
    }

    /// Returns the world of a trial.
    pub(super) fn maze(&self, trial: usize) -> &Maze {
        let maze = named(&self.worlds, &self.arm(trial).world);
        maze.expect("arms name worlds of their study")
    }

    /// Returns the plan of the first trial of each arm.
    pub fn arm_plans(&self) -> impl Iterator<Item = Plan> + '_ {
        (0..self.arms.len()).map(|arm| self.plan(arm * self.trials))
    }

    /// Returns the configuration of a trial, with the settings that depend on its world filled in.
    pub(super) fn config(&self, trial: usize) -> Config {
        let arm = self.arm(trial);
        Config {
            version: self.version.clone(),
            method: arm.method,
            arena: arm.arena,
            sensor: arm.sensor,
            episodes: self.episodes,
            seed: self.trial_seed(trial),
            settings: arm.settings.clone().settled_in(self.maze(trial)),
            initial: None,
        }
    }

    /// Returns the plan of a trial.
    pub fn plan(&self, trial: usize) -> Plan {
        Plan {
            maze: self.maze(trial).clone(),
            config: self.config(trial),
        }
    }

    /// Checks that every arm names a world of the study, and that all settings are in range.
    pub(super) fn check(&self) -> Result<(), String> {
        let known = |arm: &Arm| named(&self.worlds, &arm.world).is_some();
        self.check_numbers().map_err(|fault| fault.to_string())?;
        self.check_names()?;
        self.check_arms()?;
        self.check_reference()?;
        if self.is_empty() {
            return Err("it has no trials: list worlds and methods".to_owned());
        }
        if !self.arms.iter().all(known) {
            return Err("it has trials in worlds that it does not contain".to_owned());
        }
        let mut firsts = (0..self.arms.len()).map(|arm| arm * self.trials);
        firsts.try_for_each(|trial| self.check_arm_of(trial))
    }

    /// Checks that the numbers of the study are in range.
    fn check_numbers(&self) -> Result<(), OutOfRange> {
        within("trials", self.trials, 1..=1_000_000)?;
        within("episodes", self.episodes, 1..=1_000_000)?;
        within("worlds", self.worlds.len(), 0..=MOST_WORLDS)?;
        within("drives", self.drives, 0..=10_000)?;
        within("combinations", self.arms.len(), 0..=MOST_ARMS)?;
        within("trials of all combinations", self.len(), 0..=MOST_TRIALS)
    }

    /// Checks the names, which must be unique and are printed to terminals.
    fn check_names(&self) -> Result<(), String> {
        if self.name.contains(char::is_control) {
            return Err("`name` contains a control character: remove it".to_owned());
        }
        let agents = self.arms.iter().filter_map(|arm| arm.agent.as_ref());
        if let Some(name) = agents.into_iter().find(|name| !is_plain_name(name)) {
            return Err(format!("invalid agent name `{name}`"));
        }
        let worlds = &self.worlds;
        let is_twin = |i: &usize| named(&worlds[..*i], worlds[*i].name()).is_some();
        match (0..worlds.len()).find(is_twin) {
            Some(twin) => Err(format!("two worlds are named `{}`", worlds[twin].name())),
            None => Ok(()),
        }
    }

    /// Rejects arms with the same name, whose rows could not be told apart.
    fn check_arms(&self) -> Result<(), String> {
        let mut names: Vec<String> = self.arms.iter().map(Arm::name).collect();
        names.sort();
        let twin = names.windows(2).find(|pair| pair[0] == pair[1]);
        twin.map_or(Ok(()), |pair| {
            Err(format!("it has `{}` twice: remove one of them", pair[0]))
        })
    }

    /// Checks the settings of an arm, and that the robot fits.
    fn check_arm_of(&self, trial: usize) -> Result<(), String> {
        let plan = self.plan(trial);
        plan.check().map_err(|fault| fault.to_string())?;
        let fits = plan.config.check_fit(&plan.maze);
        fits.map_err(|fault| fault.to_string())
    }
}

fn is_none(number: &u32) -> bool {
    *number == 0
}

fn named<'a>(mazes: &'a [Maze], name: &str) -> Option<&'a Maze> {
    mazes.iter().find(|maze| maze.name() == name)
}

/// Returns the id of the study with this text.
pub(super) fn id_of(json: &str) -> String {
    format!("{:08x}", crc32fast::hash(json.as_bytes()))
}

/// Returns true for a valid name of a custom agent or of a variant. It is printed in tables, pages
/// and terminals.
pub(super) fn is_plain_name(name: &str) -> bool {
    let is_plain = |letter: char| matches!(letter, 'a'..='z' | '0'..='9' | '-');
    (1..=40).contains(&name.len()) && name.chars().all(is_plain)
}

/// Freezes the study file `s.toml` with this text and these settings of the command line.
#[cfg(test)]
pub(super) fn frozen(text: &str, sets: &[&str]) -> Result<Protocol, Error> {
    let mut file = StudyFile::parse(text, "s.toml", std::path::Path::new(""))?;
    file.sets = sets.iter().map(|set| (*set).to_owned()).collect();
    Protocol::new(&file, &Agents::default())
}

fn write_mazes<S: Serializer>(mazes: &[Maze], out: S) -> Result<S::Ok, S::Error> {
    let raw = |maze: &Maze| RawValue::from_string(maze.to_json().trim_end().to_owned());
    let raws: Result<Vec<_>, _> = mazes.iter().map(raw).collect();
    raws.map_err(serde::ser::Error::custom)?.serialize(out)
}

fn read_mazes<'de, D: Deserializer<'de>>(source: D) -> Result<Vec<Maze>, D::Error> {
    let raws = Vec::<Box<RawValue>>::deserialize(source)?;
    let maze = |raw: &RawValue| Maze::from_json(raw.get().as_bytes(), "the study's world");
    raws.iter()
        .map(|raw| maze(raw))
        .collect::<Result<_, _>>()
        .map_err(serde::de::Error::custom)
}
