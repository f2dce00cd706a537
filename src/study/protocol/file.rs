//! Study files, which the user writes.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::{Table, Value};

use super::{StudyKey, shipped};
use crate::agent::Method;
use crate::arena::ArenaKind;
use crate::disk;
use crate::sensor::Sensor;
use crate::study::error;
use crate::trial::{MOST_TOML_BYTES, RobotProfile, Settings, shortened, similar};
use crate::world::{Maze, Recipe};
use crate::world::{bundled_world, bundled_worlds};
use crate::{Error, ErrorKind};

/// A study file, and what the command line or a program changes in it. `keys.toml` describes the keys.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct StudyFile {
    /// The study's name.
    pub name: String,
    pub(super) worlds: Vec<String>,
    pub(super) methods: Vec<Method>,
    /// The arenas.
    #[serde(default = "StudyFile::grid")]
    pub arenas: Vec<ArenaKind>,
    #[serde(default)]
    pub(super) sensors: Option<Vec<Sensor>>,
    /// Trials per arm.
    pub trials: usize,
    /// Episodes per trial.
    pub episodes: u32,
    #[serde(default)]
    pub(super) drives: u32,
    /// Root seed of all trials.
    #[serde(default = "StudyFile::one")]
    pub seed: u64,
    /// The method, or the custom agent, that the report compares with each other one.
    #[serde(default)]
    pub reference: Option<String>,
    #[serde(default)]
    pub(super) robot: Option<String>,
    #[serde(default)]
    pub(super) settings: Table,
    #[serde(default)]
    pub(super) world_settings: BTreeMap<String, Table>,
    #[serde(default)]
    pub(super) world_sensors: BTreeMap<String, Vec<Sensor>>,
    #[serde(default)]
    pub(super) method_settings: BTreeMap<String, Table>,
    #[serde(default)]
    pub(super) sweep: Option<Value>,
    #[serde(default)]
    pub(super) without: Vec<String>,
    /// Settings as `section.key=value`, which override all others.
    #[serde(skip)]
    pub sets: Vec<String>,
    /// The name of the file, for messages.
    #[serde(skip)]
    pub(super) origin: String,
    /// The base folder of relative paths of worlds.
    #[serde(skip)]
    folder: PathBuf,
}

/// Stands for no switch in `without`.
pub const NOTHING: &str = "nothing";

impl StudyFile {
    fn grid() -> Vec<ArenaKind> {
        vec![ArenaKind::Grid]
    }

    fn one() -> u64 {
        1
    }

    /// Returns the error for a fault in the file.
    pub(super) fn fault(&self, fault: impl Display) -> Error {
        error::file(&self.origin, fault)
    }

    /// Loads a shipped study, such as `paper`, or else a file.
    ///
    /// # Errors
    /// When there is no such file, or the file is not a valid study.
    pub fn load(name: &Path) -> Result<Self, Error> {
        if let Some(text) = name.to_str().and_then(shipped::study) {
            return Self::parse(text, &name.display().to_string(), Path::new(""));
        }
        let text = disk::read_text(name, MOST_TOML_BYTES).map_err(|cause| match cause.kind() {
            io::ErrorKind::NotFound => missing(name),
            io::ErrorKind::InvalidData | io::ErrorKind::FileTooLarge => {
                error::file(&name.display().to_string(), cause)
            }
            _ => error::io(name)(cause),
        })?;
        let (folder, origin) = (name.parent().unwrap_or(Path::new("")), name.display());
        let parsed = Self::parse(&text, &origin.to_string(), folder);
        parsed.map_err(|fault| match Maze::from_json(text.as_bytes(), "world") {
            Ok(_) => ErrorKind::BadData.error(world_for_study(name)),
            Err(_) => fault,
        })
    }

    /// Parses the text of a study file. Messages name it by `origin`. Paths of worlds are relative
    /// to `folder`.
    ///
    /// # Errors
    /// When the text is not a valid study.
    pub fn parse(text: &str, origin: &str, folder: &Path) -> Result<Self, Error> {
        let fault = |fault: toml::de::Error| error::file(origin, shortened(&fault.to_string()));
        let table = toml::from_str(text).map_err(fault)?;
        check_names(&table).map_err(|fault| error::file(origin, fault))?;
        Ok(Self {
            origin: origin.to_owned(),
            folder: folder.to_owned(),
            ..toml::from_str(text).map_err(fault)?
        })
    }

    /// Loads the worlds, which are names of shipped or generated worlds, or paths.
    pub(super) fn worlds(&self) -> Result<Vec<Maze>, Error> {
        let names = self.worlds.iter();
        names.map(|name| self.world(name)).collect()
    }

    fn world(&self, name: &str) -> Result<Maze, Error> {
        if let Some(text) = bundled_world(name) {
            return Ok(Maze::from_json(text.as_bytes(), name)?);
        }
        if let Ok(recipe) = name.parse::<Recipe>() {
            return recipe.maze().map_err(|fault| self.fault(fault));
        }
        if !name.ends_with(".json") {
            let names = bundled_worlds().collect::<Vec<_>>().join(", ");
            let fault = format!(
                "there is no world `{name}`: give a path to a .json file, one of {names}, or kind, \
                 size and seed of a generated one, such as rooms-12-3"
            );
            return Err(self.fault(fault));
        }
        Ok(Maze::load(&self.folder.join(name))?)
    }

    /// Returns the default settings of a method, overridden by those of the study's robot.
    pub(super) fn robot_settings(&self, method: Method) -> Result<Settings, Error> {
        let defaults = Settings::of(method);
        let Some(robot) = &self.robot else {
            return Ok(defaults);
        };
        let path = self.folder.join(robot);
        let name = match robot.ends_with(".toml") {
            true => path.to_str().unwrap_or(robot),
            false => robot,
        };
        let profile = RobotProfile::load(name);
        let settings = profile.and_then(|profile| Ok(profile.settings_over(&defaults)?));
        settings.map_err(|fault| self.fault(fault))
    }

    /// Returns the settings of one world.
    pub(super) fn world_settings(&self, world: &str) -> Table {
        let settings = self.world_settings.get(world);
        settings.cloned().unwrap_or_default()
    }

    /// Returns the sensors in one world and arena.
    pub(super) fn sensors(&self, world: &str, arena: ArenaKind) -> Vec<Sensor> {
        let own = self.world_sensors.get(world);
        let chosen = own.or(self.sensors.as_ref()).cloned();
        chosen.unwrap_or_else(|| vec![Sensor::usual_in(arena)])
    }

    /// Rejects settings and sensors of worlds that are not in the study.
    pub(super) fn check_worlds(&self, worlds: &[Maze]) -> Result<(), Error> {
        let settings = self.world_settings.keys();
        let mut named = settings.chain(self.world_sensors.keys());
        let unknown = named.find(|name| !worlds.iter().any(|maze| maze.name() == *name));
        unknown.map_or(Ok(()), |name| {
            let fault = format!("`{name}` is not a world of this study");
            Err(self.fault(fault))
        })
    }

    /// Returns the settings of one method.
    pub(super) fn method_settings(&self, method: Method) -> Table {
        let settings = self.method_settings.get(method.name());
        settings.cloned().unwrap_or_default()
    }
}

/// Returns the error for a study that is neither a file nor shipped.
fn missing(name: &Path) -> Error {
    let shown = name.to_string_lossy();
    if bundled_world(&shown).is_some() {
        return ErrorKind::Missing.error(world_for_study(name));
    }
    let all = shipped::names().collect::<Vec<_>>().join(", ");
    let near = similar(&shown, shipped::names());
    let hint = near.map_or(String::new(), |name| format!("; did you mean `{name}`?"));
    let message = format!("unknown study \"{shown}\": pass a TOML file or one of: {all}{hint}");
    ErrorKind::Missing.error(message)
}

/// Returns the message for a world in the place of a study.
fn world_for_study(world: &Path) -> String {
    let world = world.display();
    format!(
        "{world} is a world, not a study: a study file (TOML) names its worlds, as in \
         `worlds = [\"{world}\"]`; the page \"Keys of a study file\" lists its keys"
    )
}

/// Rejects an unknown name of a key, a method, an arena or a sensor.
fn check_names(table: &Table) -> Result<(), String> {
    let keys = StudyKey::all();
    let keys = keys.iter().map(|key| key.name.as_str()).collect();
    check_known("key", table.keys().map(String::as_str), keys)?;
    let listed = |key: &str| {
        let values = table.get(key).and_then(Value::as_array);
        values.into_iter().flatten().filter_map(Value::as_str)
    };
    let methods: Vec<&str> = Method::ALL.iter().map(|method| method.name()).collect();
    check_known("method", listed("methods"), methods.clone())?;
    let own = table.get("method-settings").and_then(Value::as_table);
    let own = own.into_iter().flat_map(Table::keys).map(String::as_str);
    check_known("method", own, methods)?;
    let arenas = ArenaKind::ALL.iter().map(|arena| arena.name());
    check_known("arena", listed("arenas"), arenas.collect())?;
    let sensors = Sensor::ALL.iter().map(|sensor| sensor.name());
    check_known("sensor", listed("sensors"), sensors.collect())
}

/// Rejects names that are not known, with a similar one or all of them.
fn check_known<'a>(
    kind: &str,
    mut names: impl Iterator<Item = &'a str>,
    known: Vec<&str>,
) -> Result<(), String> {
    let Some(name) = names.find(|name| !known.contains(name)) else {
        return Ok(());
    };
    let hint = match similar(name, known.iter().copied()) {
        Some(known) => format!("; did you mean `{known}`?"),
        None => format!(", only {}", known.join(", ")),
    };
    Err(format!("there is no {kind} `{}`{hint}", shortened(name)))
}

#[cfg(test)]
mod tests {
    use crate::study::protocol::frozen;

    const SMALL: &str =
        "name = \"s\"\nworlds = [\"maze4\"]\nmethods = [\"xcs\"]\ntrials = 2\nepisodes = 3\n";

    #[test]
    fn mistakes_in_a_study_file_are_named_with_a_similar_name_or_all_names() {
        let changed = |from: &str, to: &str| SMALL.replace(from, to);
        let with = |more: &str| format!("{SMALL}{more}\n");
        for (text, words) in [
            (
                with("episods = 4"),
                "s.toml: there is no key `episods`; did you mean `episodes`?",
            ),
            (
                with("[sweep]\n\"xcs.betta\" = [0.1]"),
                "s.toml, sweep: there is no setting `xcs.betta`; did you mean `xcs.beta`?",
            ),
            (changed("maze4", "maze99"), "there is no world `maze99`"),
            (
                changed("\"xcs\"", "\"q-lerning\""),
                "there is no method `q-lerning`; did you mean `q-learning`?",
            ),
            (changed("\"xcs\"", "\"xcs\", \"xcs\""), "twice: remove"),
            (changed("\"maze4\"", ""), "it has no trials"),
            (
                changed("\"xcs\"", "\"?\""),
                "there is no method `?`, only xcs, xcsam,",
            ),
            (
                with("arenas = [\"fysics\"]"),
                "there is no arena `fysics`; did you mean `physics`?",
            ),
            (
                with("sensors = [\"lydar\"]"),
                "there is no sensor `lydar`; did you mean `lidar`?",
            ),
            (
                changed("\"s\"", r#""\u001b[31mred""#),
                "a control character",
            ),
            (with("[sweep]\n\"xcs.beta\" = []"), "has no values"),
            (with("sweep = [1]"), "`sweep` must be a table of settings"),
            (with("sweep = []"), "`sweep` must be a table of settings"),
            (
                with("[sweep]\nname = \"A b\""),
                "`sweep.name` must be a text of",
            ),
            (
                with("[method-settings.xcsr]\n\"xcs.beta\" = 0.1"),
                "there is no method `xcsr`; did you mean `xcscr`?",
            ),
        ] {
            let message = frozen(&text, &[]).unwrap_err().to_string();
            assert!(message.contains(words), "{message}");
        }
        frozen(SMALL, &[]).expect("control");
    }
}
