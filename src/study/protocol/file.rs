//! Study files: what the user writes.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::{Table, Value};

use super::keys::names;
use super::shipped;
use crate::agent::Method;
use crate::arena::ArenaKind;
use crate::disk;
use crate::sensor::Sensor;
use crate::study::error::StudyError;
use crate::trial::{MOST_TOML_BYTES, RobotProfile, Settings, flatten, shortened, similar};
use crate::world::{Maze, Recipe};
use crate::world::{bundled_world, bundled_worlds};
use xcs::bounds::OutOfRange;

/// What a study file says, before it is frozen into a [`Protocol`](super::Protocol).
#[derive(Debug, Clone, PartialEq)]
pub struct StudyFile {
    pub(super) origin: String,
    /// Where relative paths of worlds begin.
    folder: PathBuf,
    pub(super) document: Document,
}

/// The keys and values of a study file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct Document {
    pub name: String,
    pub worlds: Vec<String>,
    /// Worlds in which trials learn beforehand, or [`NOTHING`]; each is tried.
    #[serde(default)]
    pub after: Vec<String>,
    pub methods: Vec<Method>,
    #[serde(default = "Document::grid")]
    pub arenas: Vec<ArenaKind>,
    /// Unless given, what is usual in each arena.
    #[serde(default)]
    pub sensors: Option<Vec<Sensor>>,
    pub trials: usize,
    pub episodes: u32,
    /// Episodes in which the policy of each finished trial is put to the test.
    #[serde(default)]
    pub drives: u32,
    #[serde(default = "Document::one")]
    pub seed: u64,
    /// The robot profile of all trials: a bundled name or a path, which begins at the folder of this file.
    #[serde(default)]
    pub robot: Option<String>,
    /// Settings of all trials.
    #[serde(default)]
    pub settings: Table,
    /// Settings of all trials in a world, which win over those of all.
    #[serde(default)]
    pub world_settings: BTreeMap<String, Table>,
    /// The percepts in a world, instead of those of all worlds.
    #[serde(default)]
    pub world_sensors: BTreeMap<String, Vec<Sensor>>,
    /// Settings of all trials of a method, which win over those of worlds.
    #[serde(default)]
    pub method_settings: BTreeMap<String, Table>,
    /// Settings, each with the list of its values: every combination is tried.
    #[serde(default)]
    pub sweep: Table,
    /// Tables of settings, each of which is tried, with every combination of the swept ones.
    #[serde(default)]
    pub variants: Vec<Table>,
    /// How many of these combinations are tried, drawn at random, instead of all.
    #[serde(default)]
    pub sample: Option<usize>,
    /// Switches that are turned off, one at a time, beside a variant with all of them as set; or settings
    /// with the value that turns them off, `key=value`.
    #[serde(default)]
    pub without: Vec<String>,
}

/// In place of a world to learn in beforehand, and of a switch to turn off.
pub const NOTHING: &str = "nothing";

impl Document {
    fn grid() -> Vec<ArenaKind> {
        vec![ArenaKind::Grid]
    }

    fn one() -> u64 {
        1
    }
}

impl StudyFile {
    /// A study that comes with the program, such as `paper`, or else a file.
    ///
    /// # Errors
    /// When there is no such file, or it describes no study.
    pub fn load(name: &Path) -> Result<Self, StudyError> {
        if let Some(text) = name.to_str().and_then(shipped::study) {
            return Self::parse(text, &name.display().to_string(), Path::new(""));
        }
        let text = disk::read_text(name, MOST_TOML_BYTES).map_err(|cause| match cause.kind() {
            ErrorKind::NotFound => StudyError::Missing {
                file: name.to_owned(),
                shipped: shipped::study_names(),
            },
            ErrorKind::InvalidData | ErrorKind::FileTooLarge => {
                StudyError::file(&name.display().to_string(), &cause.to_string())
            }
            _ => StudyError::io(name, cause),
        })?;
        let folder = name.parent().unwrap_or(Path::new(""));
        Self::parse(&text, &name.display().to_string(), folder)
    }

    /// Reads the text of a study file, which `origin` names in messages. Paths of worlds begin
    /// at `folder`.
    ///
    /// # Errors
    /// When the text describes no study.
    pub fn parse(text: &str, origin: &str, folder: &Path) -> Result<Self, StudyError> {
        let fault = |fault: String| StudyError::file(origin, &in_words(&fault));
        let table: Table = text
            .parse()
            .map_err(|e: toml::de::Error| fault(e.to_string()))?;
        if let Some(key) = table.keys().find(|key| !names().any(|name| name == *key)) {
            return Err(fault(unknown_key(key)));
        }
        let document: Document =
            toml::from_str(text).map_err(|e: toml::de::Error| fault(e.to_string()))?;
        Ok(Self {
            origin: origin.to_owned(),
            folder: folder.to_owned(),
            document,
        })
    }

    /// The worlds: names of shipped or generated ones, or paths.
    pub(super) fn worlds(&self) -> Result<Vec<Maze>, StudyError> {
        let names = self.document.worlds.iter();
        names.map(|name| self.world(name)).collect()
    }

    /// The worlds in which trials learn beforehand; `None` for [`NOTHING`].
    pub(super) fn earlier_worlds(&self) -> Result<Vec<Option<Maze>>, StudyError> {
        let world = |name: &String| match name == NOTHING {
            true => Ok(None),
            false => self.world(name).map(Some),
        };
        self.document.after.iter().map(world).collect()
    }

    fn world(&self, name: &str) -> Result<Maze, StudyError> {
        if let Some(text) = bundled_world(name) {
            return Ok(Maze::from_json(text.as_bytes(), name)?);
        }
        if let Ok(recipe) = name.parse::<Recipe>() {
            let fault = |fault: OutOfRange| StudyError::file(&self.origin, &fault.to_string());
            return recipe.maze().map_err(fault);
        }
        if !name.ends_with(".json") {
            let names = bundled_worlds().collect::<Vec<_>>().join(", ");
            let fault = format!(
                "there is no world `{name}`: give a path to a .json file, one of {names}, or kind, \
                 size and seed of a generated one, such as rooms-12-3"
            );
            return Err(StudyError::file(&self.origin, &fault));
        }
        Ok(Maze::load(&self.folder.join(name))?)
    }

    /// The default settings with those of the study's robot.
    pub(super) fn robot_settings(&self) -> Result<Settings, StudyError> {
        let defaults = Settings::default();
        let Some(robot) = &self.document.robot else {
            return Ok(defaults);
        };
        let path = self.folder.join(robot);
        let name = match robot.ends_with(".toml") {
            true => path.to_str().unwrap_or(robot),
            false => robot,
        };
        let profile = RobotProfile::load(name);
        let settings = profile.and_then(|profile| Ok(profile.settings_over(&defaults)?));
        settings.map_err(|fault| StudyError::file(&self.origin, &fault.to_string()))
    }

    /// The settings in one world.
    pub(super) fn world_settings(&self, world: &str) -> Table {
        let settings = self.document.world_settings.get(world);
        settings.cloned().unwrap_or_default()
    }

    /// The percepts in one world and arena.
    pub(super) fn sensors(&self, world: &str, arena: ArenaKind) -> Vec<Sensor> {
        let own = self.document.world_sensors.get(world);
        let chosen = own.or(self.document.sensors.as_ref()).cloned();
        chosen.unwrap_or_else(|| vec![Sensor::usual_in(arena)])
    }

    /// Refuses settings and percepts in worlds that are not those of the study.
    pub(super) fn check_worlds(&self, worlds: &[Maze]) -> Result<(), StudyError> {
        let Document {
            world_settings,
            world_sensors,
            ..
        } = &self.document;
        let mut named = world_settings.keys().chain(world_sensors.keys());
        let unknown = named.find(|name| !worlds.iter().any(|maze| maze.name() == *name));
        unknown.map_or(Ok(()), |name| {
            let fault = format!("`{name}` is not a world of this study");
            Err(StudyError::file(&self.origin, &fault))
        })
    }

    /// The settings of one method, by its name.
    pub(super) fn method_settings(&self, method: Method) -> Result<Table, StudyError> {
        let settings = &self.document.method_settings;
        let known = |name: &str| Method::ALL.iter().any(|method| method.name() == name);
        if let Some(name) = settings.keys().find(|name| !known(name)) {
            let names: Vec<&str> = Method::ALL.iter().map(|method| method.name()).collect();
            let fault = format!("there is no method `{name}`, only {}", names.join(", "));
            return Err(StudyError::file(&self.origin, &fault));
        }
        Ok(settings.get(method.name()).cloned().unwrap_or_default())
    }

    /// The swept settings in the order of their full names, each with its values.
    pub(super) fn sweep(&self) -> Result<Vec<(String, Vec<Value>)>, StudyError> {
        let mut entries = flatten(self.document.sweep.clone());
        entries.sort_by(|a, b| a.0.cmp(&b.0));
        let list = |(key, value): (String, Value)| match value {
            Value::Array(values) if !values.is_empty() => Ok((key, values)),
            _ => Err(StudyError::file(
                &self.origin,
                &format!("`sweep.{key}` must be a list of values, such as [0.1, 0.2]"),
            )),
        };
        entries.into_iter().map(list).collect()
    }
}

fn unknown_key(key: &str) -> String {
    match similar(key, names()) {
        Some(known) => format!("there is no key `{key}`; did you mean `{known}`?"),
        None => {
            let all: Vec<&str> = names().collect();
            format!("there is no key `{key}`, only {}", all.join(", "))
        }
    }
}

/// The words of the TOML library, but of a name that is none of a closed set: there, the nearest one or else all of them.
fn in_words(fault: &str) -> String {
    let named = || {
        let (place, rest) = fault.split_once("unknown variant `")?;
        let (name, known) = rest.split_once("`, expected ")?;
        let known = known.split('`').skip(1).step_by(2);
        let nearest = similar(name, known.clone());
        let all = || known.collect::<Vec<_>>().join(", ");
        let hint = nearest.map_or_else(
            || format!("give one of {}", all()),
            |name| format!("did you mean `{name}`?"),
        );
        Some(format!("{place}there is no `{}`: {hint}", shortened(name)))
    };
    named().unwrap_or_else(|| shortened(fault))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SMALL: &str =
        "name = \"s\"\nworlds = [\"maze4\"]\nmethods = [\"xcs\"]\ntrials = 2\nepisodes = 3\n";

    fn message(text: &str) -> String {
        let file = StudyFile::parse(text, "s.toml", Path::new(""));
        let frozen =
            file.and_then(|file| crate::study::protocol::Protocol::new(&file, &Default::default()));
        frozen.unwrap_err().to_string()
    }

    #[test]
    fn an_unknown_key_is_answered_with_a_similar_one() {
        let text = format!("{SMALL}episods = 4\n");
        assert_eq!(
            message(&text),
            "s.toml: there is no key `episods`; did you mean `episodes`?"
        );
        let text = format!("{SMALL}[sweep]\n\"xcs.betta\" = [0.1]\n");
        assert_eq!(
            message(&text),
            "s.toml, sweep: there is no setting `xcs.betta`; did you mean `xcs.beta`?"
        );
    }

    #[test]
    fn a_world_that_is_not_shipped_needs_a_path() {
        let text = SMALL.replace("maze4", "maze99");
        assert!(message(&text).contains("there is no world `maze99`"));
    }

    #[test]
    fn an_unknown_method_is_answered_with_a_similar_one_or_with_all_of_them() {
        let named = message(&SMALL.replace("\"xcs\"", "\"q-lerning\""));
        assert!(
            named.ends_with("there is no `q-lerning`: did you mean `q-learning`?"),
            "{named}"
        );
        let named = message(&SMALL.replace("\"xcs\"", "\"?\""));
        assert!(
            named.contains("give one of xcs, xcsam,") && named.ends_with("r-max"),
            "{named}"
        );
    }

    #[test]
    fn a_name_cannot_command_the_terminal() {
        let text = SMALL.replace("\"s\"", r#""\u001b[31mred""#);
        assert!(message(&text).contains("a control character"));
    }

    #[test]
    fn a_sweep_needs_lists_and_methods_must_exist() {
        assert!(
            message(&format!("{SMALL}[sweep]\n\"xcs.beta\" = 0.1\n")).contains("must be a list")
        );
        let text = format!("{SMALL}[method-settings.xcsr]\n\"xcs.beta\" = 0.1\n");
        assert!(message(&text).contains("there is no method `xcsr`"));
    }
}
