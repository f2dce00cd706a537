//! Why settings cannot be used, and where each one came from.

use std::fmt;

use xcs::bounds::OutOfRange;

/// Where the value of a setting came from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SettingOrigin {
    /// Nobody set it.
    Default,
    /// A settings file, by its name.
    File(String),
    /// A robot profile, by its name.
    Robot(String),
    /// `--set` on the command line.
    Set,
    /// Nobody set it, and the default is not enough for the maze.
    Maze,
}

impl fmt::Display for SettingOrigin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Default => f.write_str("default"),
            Self::File(name) => f.write_str(name),
            Self::Robot(name) => write!(f, "robot {name}"),
            Self::Set => f.write_str("--set"),
            Self::Maze => f.write_str("the maze"),
        }
    }
}

/// Why settings cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SettingsError {
    /// The file is no TOML.
    #[error("{origin} is not valid TOML: {fault}")]
    Syntax {
        /// Which file.
        origin: SettingOrigin,
        /// What the TOML parser says, with line and column.
        fault: String,
    },
    /// `--set` without an equals sign.
    #[error("`--set {0}` has no value: write `--set section.key=value`")]
    NoValue(String),
    /// There is no such setting.
    #[error("{origin}: there is no setting `{key}`{}", did_you_mean(.suggestion))]
    Unknown {
        /// The key that was given.
        key: String,
        /// Where.
        origin: SettingOrigin,
        /// A setting with a similar name.
        suggestion: Option<String>,
    },
    /// The value is of the wrong type.
    #[error("{origin}: `{key}` is {given}, but must be {wanted}")]
    Type {
        /// The setting.
        key: String,
        /// Where.
        origin: SettingOrigin,
        /// The value that was given.
        given: String,
        /// What it must be.
        wanted: String,
    },
    /// Nothing in the run reads the setting.
    #[error("{origin}: `{key}` has no effect: {why}")]
    Unread {
        /// The setting.
        key: String,
        /// Where.
        origin: SettingOrigin,
        /// Why it has no effect, and what reads it.
        why: String,
    },
    /// A robot was chosen for an arena that has none.
    #[error("the robot profile has no effect: the arena `grid` has no robot, `physics` has one")]
    NoRobot,
    /// The value lies outside of its range.
    #[error("{origin}: {fault}")]
    Range {
        /// Where.
        origin: SettingOrigin,
        /// Which setting, and its range.
        fault: OutOfRange,
    },
}

fn did_you_mean(suggestion: &Option<String>) -> String {
    let hint = "; `xcscr config show --resolved` lists all".to_owned();
    suggestion
        .as_ref()
        .map_or(hint, |key| format!("; did you mean `{key}`?"))
}
