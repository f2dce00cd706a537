//! Robot profiles: the settings of one robot, with the source of each figure.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::{Table, Value};

use super::resolve::{Resolved, flatten, similar};
use super::settings::Settings;
use super::settings_error::SettingsError;
use super::toml_text::{MOST_TOML_BYTES, shortened};
use xcscr_robot::arena::PhysicsParams;
use xcscr_robot::input;

/// The profiles that come with the program, by name.
const BUNDLED: [(&str, &str); 4] = [
    ("default", include_str!("../../robots/default.toml")),
    (
        "turtlebot3-burger",
        include_str!("../../robots/turtlebot3-burger.toml"),
    ),
    (
        "turtlebot3-waffle-pi",
        include_str!("../../robots/turtlebot3-waffle-pi.toml"),
    ),
    (
        "turtlebot4-lite",
        include_str!("../../robots/turtlebot4-lite.toml"),
    ),
];

/// The order in which scans list their beams.
#[derive(
    Debug,
    Clone,
    Copy,
    Default,
    PartialEq,
    Eq,
    Deserialize,
    strum::VariantArray,
    strum::IntoStaticStr,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum ScanOrder {
    /// From the first to the last. The stamp is the time of the first.
    #[default]
    Forward,
    /// From the last to the first. The stamp is the time of the last. The drivers of the LDS-01, LDS-02
    /// and LDS-03 do so.
    Reversed,
    /// From the last to the first. The stamp is the time of the first. The driver of the RPLIDAR does
    /// so.
    ReversedFromFirst,
}

/// The settings of one robot. Each value can name its source, such as a data sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotProfile {
    name: String,
    title: String,
    scan_order: ScanOrder,
    /// Tables of settings, as in a settings file.
    settings: Table,
    /// The source of a value, by the full name of its setting.
    sources: BTreeMap<String, String>,
}

/// The file of a profile.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    title: String,
    #[serde(default)]
    scan_order: ScanOrder,
    #[serde(default)]
    physics: Table,
    #[serde(default)]
    source: Table,
}

impl RobotProfile {
    /// Returns the names of the profiles that come with the program.
    pub fn bundled_names() -> impl Iterator<Item = &'static str> {
        BUNDLED.iter().map(|(name, _)| *name)
    }

    /// Loads a bundled profile by its name, or else a TOML file by its path.
    ///
    /// # Errors
    /// When there is no such profile or file, when the file is not a profile, or when a setting is unknown
    /// or out of range.
    pub fn load(name: &str) -> Result<Self, RobotError> {
        if let Some((name, text)) = BUNDLED.iter().find(|(bundled, _)| *bundled == name) {
            return Self::parse(text, name);
        }
        if !name.ends_with(".toml") {
            return Err(RobotError::Unknown {
                name: shortened(name),
                suggestion: similar(name, Self::bundled_names()),
            });
        }
        let path = Path::new(name);
        let text = input::read_text(path, MOST_TOML_BYTES).map_err(|cause| RobotError::Read {
            path: path.to_owned(),
            cause,
        })?;
        Self::parse(&text, name)
    }

    /// Parses the text of a profile. Messages use `name`.
    ///
    /// # Errors
    /// When the text is not a profile, or a setting is unknown or out of range.
    pub fn parse(text: &str, name: &str) -> Result<Self, RobotError> {
        let invalid = |fault: &str| RobotError::Invalid {
            name: name.to_owned(),
            fault: shortened(fault),
        };
        let document: Document = toml::from_str(text).map_err(|e| invalid(&e.to_string()))?;
        let mut settings = Table::new();
        settings.insert("physics".to_owned(), Value::Table(document.physics));
        let mut sources = BTreeMap::new();
        for (key, source) in flatten(document.source) {
            let source = source
                .as_str()
                .ok_or_else(|| invalid(&format!("`source.{key}` must be a string")))?;
            sources.insert(key, source.to_owned());
        }
        let profile = Self {
            name: name.to_owned(),
            title: document.title,
            scan_order: document.scan_order,
            settings,
            sources,
        };
        profile.settings_over(&Settings::default())?;
        Ok(profile)
    }

    /// Returns the name of a bundled profile, or the path of a file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the manufacturer's name of the robot.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// Returns the order in which the driver of the robot's lidar lists the beams of a scan.
    pub fn scan_order(&self) -> ScanOrder {
        self.scan_order
    }

    /// Returns the keys of the file that are no settings, as lines of TOML.
    pub fn head_toml(&self) -> String {
        let title = Value::String(self.title.clone());
        match self.scan_order {
            ScanOrder::Forward => format!("title = {title}\n"),
            order => format!(
                "title = {title}\nscan_order = \"{}\"\n",
                <&str>::from(order)
            ),
        }
    }

    /// Returns each setting of the robot with its value as written in TOML, and its source where given.
    pub fn entries(&self) -> Vec<(String, String, Option<&str>)> {
        let with_source = |(key, value): (String, Value)| {
            let source = self.sources.get(&key).map(String::as_str);
            (key, value.to_string(), source)
        };
        let flat = flatten(self.settings.clone());
        flat.into_iter().map(with_source).collect()
    }

    /// Returns `base` with this robot in place of its own. Settings that the profile does not name get their
    /// defaults. The noise level, the localisation and the faults stay.
    ///
    /// # Errors
    /// When a setting is unknown or out of range.
    pub fn settings_over(&self, base: &Settings) -> Result<Settings, SettingsError> {
        Ok(Resolved::with_robot(base, Some(self), &[], &[])?.settings)
    }
}

/// Returns `settings` with the default robot in place of their own.
fn without_robot(settings: &Settings) -> Settings {
    let own = &settings.physics;
    let physics = PhysicsParams {
        noise: own.noise,
        localisation: own.localisation,
        faults: own.faults.clone(),
        ..PhysicsParams::default()
    };
    Settings {
        physics,
        ..settings.clone()
    }
}

impl Resolved {
    /// Like [`Resolved::new`], with a robot in place of the robot of `base`, below the files.
    ///
    /// # Errors
    /// The first fault, with its place and a hint.
    pub fn with_robot(
        base: &Settings,
        robot: Option<&RobotProfile>,
        files: &[(&str, &str)],
        sets: &[String],
    ) -> Result<Self, SettingsError> {
        let replaced = robot.map(|_| without_robot(base));
        let robot = robot.map(|robot| (robot.name(), &robot.settings));
        Self::on(replaced.as_ref().unwrap_or(base), robot, files, sets)
    }
}

/// Errors when loading a robot profile.
#[derive(Debug, thiserror::Error)]
pub enum RobotError {
    /// The name is neither a bundled profile nor a TOML file.
    #[error(
        "unknown robot `{name}`: pass a .toml file or one of {}{}",
        RobotProfile::bundled_names().collect::<Vec<_>>().join(", "),
        suggestion.as_ref().map_or(String::new(), |name| format!("; did you mean `{name}`?"))
    )]
    Unknown {
        /// The name that was given.
        name: String,
        /// A bundled profile with a similar name.
        suggestion: Option<String>,
    },
    /// The file cannot be read.
    #[error("cannot read {}: {cause}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The cause.
        cause: io::Error,
    },
    /// The text is not a profile.
    #[error("{name} is not a robot profile: {fault}")]
    Invalid {
        /// The profile's name or path.
        name: String,
        /// The message of the parser, with line and column.
        fault: String,
    },
    /// A setting is unknown or out of range.
    #[error(transparent)]
    Settings(#[from] SettingsError),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bundled_profile_can_be_loaded_and_names_the_source_of_each_figure() {
        for name in RobotProfile::bundled_names() {
            let profile = RobotProfile::load(name).unwrap();
            let entries = profile.entries();
            assert!(entries.len() >= 9, "{name}: {entries:?}");
            for (key, _, source) in &entries {
                assert!(source.is_some(), "{name}: `{key}` has no source");
            }
            let known = |key: &String| entries.iter().any(|(entry, ..)| entry == key);
            let strange = profile.sources.keys().find(|key| !known(key));
            assert_eq!(strange, None, "{name}: a source for a missing setting");
        }
    }

    #[test]
    fn the_default_robot_is_the_one_of_the_default_settings() {
        let robot = RobotProfile::load("default").unwrap();
        let defaults = Settings::default();
        assert_eq!(robot.settings_over(&defaults).unwrap(), defaults);
        let burger = RobotProfile::load("turtlebot3-burger").unwrap();
        let settings = burger.settings_over(&defaults).unwrap();
        assert_ne!(settings, defaults, "control");
        let physics = settings.physics;
        let sheet = [0.105, 0.160, 0.22, 2.84, 0.12, 3.5, 5.0];
        let lidar = &physics.lidar;
        let own = [
            physics.radius_m,
            physics.wheel_base_m,
            physics.max_speed_mps,
            physics.max_turn_radps,
            lidar.nearest_m,
            lidar.range_m,
            lidar.rate_hz,
        ];
        assert_eq!((own, lidar.beams), (sheet, 360));
    }

    #[test]
    fn a_profile_replaces_the_whole_robot_and_leaves_noise_and_rewards() {
        let [default, burger] =
            ["default", "turtlebot3-burger"].map(|name| RobotProfile::load(name).unwrap());
        let mut base = burger.settings_over(&Settings::default()).unwrap();
        assert_eq!(default.settings_over(&base).unwrap(), Settings::default());
        assert_ne!(base, Settings::default(), "control");
        base.physics.noise = 2.0;
        base.reward.goal = 7.0;
        let replaced = default.settings_over(&base).unwrap();
        let physics = &replaced.physics;
        assert_eq!((physics.noise, replaced.reward.goal), (2.0, 7.0));
    }

    #[test]
    fn a_text_that_is_not_a_profile_is_refused_with_the_reason() {
        let message = |text: &str| {
            RobotProfile::parse(text, "own.toml")
                .unwrap_err()
                .to_string()
        };
        assert!(message("title = 3").starts_with("own.toml is not a robot profile"));
        assert!(message("title = \"own\"\n[xcs]\nbeta = 0.1").contains("unknown field `xcs`"));
        assert_eq!(
            message("title = \"own\"\n[physics]\nradius = 0.1"),
            "robot own.toml: there is no setting `physics.radius`; did you mean `physics.radius_m`?"
        );
        assert_eq!(
            message("title = \"own\"\n[physics]\nradius_m = 30"),
            "robot own.toml: `physics.radius_m` is 30, but must be from 0.02 to 2"
        );
    }

    #[test]
    fn an_unknown_robot_is_answered_with_the_known_ones() {
        let message = RobotProfile::load("turtlebot3").unwrap_err().to_string();
        assert!(message.contains("default, turtlebot3-burger"), "{message}");
        assert!(
            message.ends_with("did you mean `turtlebot3-burger`?"),
            "{message}"
        );
        let missing = RobotProfile::load("nowhere/robot.toml");
        assert!(
            matches!(missing, Err(RobotError::Read { .. })),
            "{missing:?}"
        );
    }
}
