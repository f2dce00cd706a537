//! Command-line arguments that several commands share.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use serde::de::IgnoredAny;
use xcscr::ErrorKind;
use xcscr::agent::{Knowledge, Method};
use xcscr::arena::ArenaKind;
use xcscr::disk;
use xcscr::run::{RecordedRun, RunFolder};
use xcscr::sensor::Sensor;
use xcscr::study::StudyFile;
use xcscr::trial::{Resolved, RobotProfile, Settings, SettingsError};
use xcscr::world::{Maze, WorldError};

use super::failure::Failure;

/// Parses one of a closed set of values by its name.
pub fn one_of<T: Copy + Send + Sync + 'static>(
    choices: &'static [T],
    name: fn(T) -> &'static str,
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(choices.iter().map(|&choice| name(choice))).map(move |text| {
        let chosen = choices.iter().find(|&&choice| name(choice) == text);
        *chosen.expect("clap lets only names of choices pass")
    })
}

/// Parses the root seed of all random streams.
pub fn seed(text: &str) -> Result<u64, String> {
    let fault = |_| format!("a seed is a whole number from 0 to {}", u64::MAX);
    text.parse().map_err(fault)
}

/// Parses a number of episodes or trials, whose range the plan or the study checks.
pub fn count<T: FromStr>(text: &str) -> Result<T, String> {
    let fault = |_| "expected a whole number from 1 to 1000000".to_owned();
    text.parse().map_err(fault)
}

/// Parses finite numbers that are separated by commas.
pub fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let numbers = text.split(',').map(|part| part.trim().parse().ok());
    let numbers: [f64; N] = numbers.collect::<Option<Vec<f64>>>()?.try_into().ok()?;
    numbers
        .iter()
        .all(|number| number.is_finite())
        .then_some(numbers)
}

/// Parses a method's name.
pub fn method() -> impl TypedValueParser<Value = Method> {
    one_of(Method::ALL, Method::name)
}

/// Parses an arena's name.
pub fn arena() -> impl TypedValueParser<Value = ArenaKind> {
    one_of(ArenaKind::ALL, ArenaKind::name)
}

/// Parses a sensor's name.
pub fn sensor() -> impl TypedValueParser<Value = Sensor> {
    one_of(Sensor::ALL, Sensor::name)
}

/// The options that determine the settings.
#[derive(Debug, clap::Args)]
pub struct SettingsArgs {
    /// The robot: a bundled profile or a TOML file; `xcscr robot show` lists them.
    #[arg(long, value_name = "NAME|FILE")]
    pub robot: Option<String>,
    /// Settings file (TOML); `xcscr config show` prints one.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Override one setting, such as `xcs.dont_care=0.5`.
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
}

impl SettingsArgs {
    /// Returns the settings applied on top of `base`. A robot profile replaces the whole robot of
    /// `base`.
    pub fn resolve(&self, base: &Settings) -> Result<Resolved, Failure> {
        let read = |path: &Path| {
            if path.is_dir() {
                Err(not_settings(path, "a folder"))
            } else {
                read_text(path, Settings::MOST_BYTES)
            }
        };
        let text = self.config.as_deref().map(read).transpose()?;
        let name = self.config.as_ref().map(|path| path.display().to_string());
        let robot = self.robot.as_deref().map(RobotProfile::load).transpose()?;
        let file = name.as_deref().zip(text.as_deref());
        let files: Vec<_> = file.into_iter().collect();
        let resolved = Resolved::with_robot(base, robot.as_ref(), &files, &self.set);
        resolved.map_err(|error| match (error, file) {
            (SettingsError::Syntax { .. }, Some((name, text))) if is_json(text) => {
                not_settings(Path::new(name), "JSON")
            }
            (error, _) => error.into(),
        })
    }
}

/// Returns the error for something else in the place of a settings file.
fn not_settings(path: &Path, what: &str) -> Failure {
    let message = format!(
        "{} is {what}, not a settings file: `--config` takes a TOML file, such as `xcscr config show` prints",
        path.display()
    );
    Failure::new(ErrorKind::BadData, message)
}

fn is_json(text: &str) -> bool {
    serde_json::from_str::<IgnoredAny>(text).is_ok()
}

/// Loads a world file by its path, or else a bundled world by its name. If the path is another kind
/// of input, the message says which.
pub fn world(path: &Path) -> Result<Maze, Failure> {
    Maze::find(path).map_err(|error| {
        let typed = disk::typed(path);
        let is_study = || StudyFile::load(path).is_ok();
        let is_run = || RunFolder::open(path).plan().is_ok();
        match error {
            WorldError::Missing { .. } if is_study() => {
                let message = format!(
                    "{typed} is a study, not a world: run it with `xcscr study run {typed}`"
                );
                Failure::new(ErrorKind::Missing, message)
            }
            WorldError::Unreadable { .. } if is_run() => {
                let file = disk::typed(&path.join("world.json"));
                let message = format!(
                    "{typed} is the folder of a run, not a world: resume an interrupted run with \
                     `xcscr train --resume {typed}`, or give the run's world, {file}"
                );
                Failure::new(ErrorKind::BadData, message)
            }
            WorldError::Invalid { .. } if is_map(path) => {
                let message = format!(
                    "{typed} is a ROS map, not a world: convert it with `xcscr world convert {typed} -o world.json \
                     --cell M --start X,Y --goal X,Y`"
                );
                Failure::new(ErrorKind::BadData, message)
            }
            error => error.into(),
        }
    })
}

/// Returns true for the YAML file of a ROS map.
fn is_map(path: &Path) -> bool {
    path.extension()
        .is_some_and(|end| end == "yaml" || end == "yml")
}

/// The most bytes that are read of a file of rules. This exceeds the largest population.
const MOST_RULES_BYTES: u64 = 1 << 30;

/// Reads the learned policy of a run folder, a recording, or a file of rules.
pub fn read_rules(path: &Path) -> Result<Knowledge, Failure> {
    if path.is_dir() {
        return Ok(RunFolder::open(path).knowledge()?);
    }
    if path.extension().is_some_and(|end| end == "mcap") {
        return Ok(RecordedRun::of(path)?.knowledge()?);
    }
    if !path.exists() && Maze::find(path).is_ok() {
        return Err(world_for_policy(path, ErrorKind::Missing));
    }
    let text = read_text(path, MOST_RULES_BYTES)?;
    serde_json::from_str(&text).map_err(|fault| match Maze::from_json(text.as_bytes(), "world") {
        Ok(_) => world_for_policy(path, ErrorKind::BadData),
        Err(_) => {
            let message = format!("{} holds no rules: {fault}", disk::typed(path));
            Failure::new(ErrorKind::BadData, message)
        }
    })
}

/// Returns the error for a world in the place of a learned policy.
fn world_for_policy(path: &Path, kind: ErrorKind) -> Failure {
    let typed = disk::typed(path);
    let message = format!(
        "{typed} is a world, not a learned policy: train in it with `xcscr train {typed}`, and pass the folder of the run"
    );
    Failure::new(kind, message)
}

/// Reads an input file of at most `most` bytes as text.
pub fn read_text(path: &Path, most: u64) -> Result<String, Failure> {
    disk::read_text(path, most).map_err(|cause| {
        let kind = ErrorKind::of_reading(&cause);
        Failure::new(kind, format!("cannot read {}: {cause}", path.display()))
    })
}
