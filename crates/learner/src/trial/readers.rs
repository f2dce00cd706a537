//! Readers of settings, for refusing settings without effect.

mod table;

use std::fmt;

use super::resolve::Resolved;
use super::settings::Settings;
use super::settings_error::{SettingOrigin, SettingsError};
use crate::agent::Method;
use xcscr_robot::arena::{ArenaKind, Localisation};
use xcscr_robot::sensor::Sensor;

use table::TABLE;

/// The parts of the program that read a setting.
#[derive(Debug, Clone)]
pub struct ReadBy(Readers);

/// The kinds of readers.
#[derive(Debug, Clone)]
enum Readers {
    /// Every run.
    Everything,
    /// Some of the methods, while they learn.
    Methods(Vec<Reader>),
    /// The robot in physics, always or only under a condition.
    Robot(Robot, Option<Condition>),
}

/// A method that reads a setting, always or only under a condition.
#[derive(Debug, Clone, Copy)]
struct Reader {
    method: Method,
    condition: Option<Condition>,
}

/// The robots in physics that read a setting.
#[derive(Debug, Clone, Copy)]
enum Robot {
    /// Every robot.
    Any,
    /// Robots that estimate their pose.
    Sensing,
    /// Robots that are given their true pose with some noise.
    GroundTruth,
    /// Robots with ground-truth percepts. Robots with sensed percepts always estimate their pose.
    WithTruePercepts,
}

/// A condition on the settings and the percept under which a setting is read.
#[derive(Debug, Clone, Copy)]
struct Condition {
    /// The condition in Markdown, mostly as arguments of `--set`.
    text: &'static str,
    holds: fn(&Scope<'_>) -> bool,
}

/// The choices that decide which settings are read: method, arena and percept.
#[derive(Debug, Clone, Copy)]
pub struct Scope<'a> {
    /// The method; `None` if a finished policy drives without learning.
    pub method: Option<Method>,
    /// The arena.
    pub arena: ArenaKind,
    /// The percept.
    pub sensor: Sensor,
    /// All settings.
    pub settings: &'a Settings,
}

impl ReadBy {
    /// Returns the readers of the setting with this full name; `None` if there is no such setting.
    pub fn of(key: &str) -> Option<&'static Self> {
        Some(&TABLE[row_of(key)?].1)
    }

    /// Returns true if the verb after the list of readers is plural.
    fn are_several(&self) -> bool {
        matches!(&self.0, Readers::Methods(readers) if readers.len() > 1)
    }
}

/// Returns the row of a setting: its own, or the row of the longest matching section.
fn row_of(key: &str) -> Option<usize> {
    let fits = |pattern: &str| match pattern.strip_suffix('*') {
        None => pattern == key,
        Some(section) => key.starts_with(section),
    };
    let rows = TABLE.iter().enumerate().filter(|(_, row)| fits(row.0));
    let exact_first = |pattern: &str| (!pattern.ends_with('*'), pattern.len());
    let best = rows.max_by_key(|(_, row)| exact_first(row.0));
    best.map(|(at, _)| at)
}

impl fmt::Display for ReadBy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0 {
            Readers::Everything => f.write_str("every run"),
            Readers::Methods(readers) => write_readers(readers, f),
            Readers::Robot(robot, condition) => {
                f.write_str(robot.words())?;
                f.write_str(&with(*condition))
            }
        }
    }
}

impl Robot {
    fn words(self) -> &'static str {
        match self {
            Self::Any => "the arena `physics`",
            Self::Sensing => {
                "a robot in `physics` that estimates its pose (percept `lidar...`, or `physics.localisation=estimated`)"
            }
            Self::GroundTruth => {
                "a robot in `physics` that does not estimate its pose (another percept than `lidar...`)"
            }
            Self::WithTruePercepts => "a robot in `physics` with another percept than `lidar...`",
        }
    }
}

/// Returns the condition as the end of a phrase, after a space; nothing without a condition.
fn with(condition: Option<Condition>) -> String {
    condition.map_or(String::new(), |one| format!(" with {}", one.text))
}

fn write_readers(readers: &[Reader], f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let always = readers.iter().all(|reader| reader.condition.is_none());
    if always && readers.len() == Method::ALL.len() {
        return f.write_str("every method");
    }
    let words = readers
        .iter()
        .map(|reader| format!("`{}`{}", reader.method.name(), with(reader.condition)));
    f.write_str(&words.collect::<Vec<_>>().join(", "))
}

impl Scope<'_> {
    /// Returns true if the setting with this full name can have an effect.
    pub fn reads(&self, key: &str) -> bool {
        ReadBy::of(key).is_some_and(|readers| match &readers.0 {
            Readers::Everything => true,
            Readers::Methods(readers) => readers
                .iter()
                .any(|reader| Some(reader.method) == self.method && self.meets(reader.condition)),
            Readers::Robot(robot, condition) => self.has(*robot) && self.meets(*condition),
        })
    }

    fn meets(&self, condition: Option<Condition>) -> bool {
        condition.is_none_or(|condition| (condition.holds)(self))
    }

    fn has(&self, robot: Robot) -> bool {
        let is_driven = self.arena == ArenaKind::Physics;
        match robot {
            Robot::Any => is_driven,
            Robot::Sensing => is_driven && self.estimates(),
            Robot::GroundTruth => is_driven && !self.estimates(),
            Robot::WithTruePercepts => is_driven && !self.sensor.is_sensed(),
        }
    }

    /// Returns true if a robot in physics estimates its pose.
    fn estimates(&self) -> bool {
        self.sensor.is_sensed() || self.settings.physics.localisation == Localisation::Estimated
    }

    /// Explains why the setting with this full name has no effect, and what reads it.
    pub fn why_unread(&self, key: &str) -> String {
        let Some(readers) = ReadBy::of(key) else {
            return "there is no such setting".to_owned();
        };
        let verb = if readers.are_several() { "do" } else { "does" };
        let who = match (&readers.0, self.method) {
            (Readers::Methods(_), None) => {
                return "the policy only drives here, and does not learn".to_owned();
            }
            (Readers::Methods(_), Some(method)) => format!("the method `{}`", method.name()),
            _ if self.arena == ArenaKind::Grid => "the arena `grid`".to_owned(),
            _ => format!("a robot with the percept `{}`", self.sensor.name()),
        };
        // Another setting turns it off.
        let is_conditional = match &readers.0 {
            Readers::Everything => false,
            Readers::Methods(readers) => readers.iter().any(|one| Some(one.method) == self.method),
            Readers::Robot(robot, _) => self.has(*robot),
        };
        let here = if is_conditional { " here" } else { "" };
        format!("{who} does not read it{here}; {readers} {verb}")
    }
}

impl Resolved {
    /// Checks that each setting that was set by hand can have an effect with this method, arena and percept. `method`
    /// is `None` if nothing learns. A settings file may repeat values without effect if they equal the present ones.
    ///
    /// # Errors
    /// [`SettingsError::NoRobot`], or [`SettingsError::Unread`] for the first setting without effect.
    pub fn check_read(
        &self,
        method: Option<Method>,
        arena: ArenaKind,
        sensor: Sensor,
    ) -> Result<(), SettingsError> {
        let mut origins = self.entries().map(|(_, _, origin)| origin);
        let is_robot = |origin: &SettingOrigin| matches!(origin, SettingOrigin::Robot(_));
        if arena == ArenaKind::Grid && origins.any(is_robot) {
            return Err(SettingsError::NoRobot);
        }
        let scope = Scope {
            method,
            arena,
            sensor,
            settings: &self.settings,
        };
        let unread = self.given.iter().find(|(key, _)| !scope.reads(key));
        unread.map_or(Ok(()), |(key, origin)| {
            Err(SettingsError::Unread {
                key: key.clone(),
                origin: origin.clone(),
                why: scope.why_unread(key),
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_setting_has_readers_and_every_row_is_of_some_setting() {
        let declared = Settings::declared();
        let rows: Option<BTreeSet<usize>> = declared.iter().map(|one| row_of(one.key)).collect();
        let used = rows.expect("each setting has a row");
        let unused = (0..TABLE.len()).find(|at| !used.contains(at));
        assert_eq!(unused.map(|at| TABLE[at].0), None);
        assert!(ReadBy::of("xcss.beta").is_none(), "control");
    }

    #[test]
    fn the_closest_row_counts() {
        let words = |key: &str| ReadBy::of(key).unwrap().to_string();
        assert_eq!(words("xcs.zeta"), "`xcsam`");
        assert_eq!(words("reward.goal"), "every method");
        assert_eq!(words("physics.cautious.when"), "the arena `physics`");
        assert!(words("physics.lidar.beams").starts_with("a robot in `physics` that estimates"));
        let on_a_map =
            "`r-max` with `plus.estimator=map` (or `auto` with percept `neighbours` or `lidar`)";
        assert!(words("map.feels_bumps").ends_with(on_a_map));
        assert_eq!(
            words("physics.wheel_noise"),
            "the arena `physics` with `physics.noise` above 0"
        );
    }
}
