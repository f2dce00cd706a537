//! Errors in settings, and the origins of settings.

use std::fmt;

use xcs::bounds::OutOfRange;

/// The origin of the value of a setting.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SettingOrigin {
    /// The default value.
    Default,
    /// A settings file, by its name.
    File(String),
    /// A robot profile, by its name.
    Robot(String),
    /// `--set` on the command line.
    Set,
    /// Raised from the default because of the maze.
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

/// Errors in settings.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SettingsError {
    /// The file is not valid TOML.
    #[error("{origin} is not valid TOML: {fault}")]
    Syntax {
        /// The file.
        origin: SettingOrigin,
        /// The message of the TOML parser, with line and column.
        fault: String,
    },
    /// A `--set` argument has no equals sign.
    #[error("`--set {0}` has no value: write `--set section.key=value`")]
    NoValue(String),
    /// There is no such setting.
    #[error("{origin}: there is no setting `{key}`{}", did_you_mean(.suggestion))]
    Unknown {
        /// The key that was given.
        key: String,
        /// The origin.
        origin: SettingOrigin,
        /// A setting with a similar name.
        suggestion: Option<String>,
    },
    /// The value is of the wrong type.
    #[error("{origin}: `{key}` is {given}, but must be {wanted}")]
    Type {
        /// The setting.
        key: String,
        /// The origin.
        origin: SettingOrigin,
        /// The value that was given.
        given: String,
        /// A description of allowed values.
        wanted: String,
    },
    /// The value is out of its range.
    #[error("{origin}: {fault}")]
    Range {
        /// The origin.
        origin: SettingOrigin,
        /// The setting and its range.
        fault: OutOfRange,
    },
}

fn did_you_mean(suggestion: &Option<String>) -> String {
    let hint = "; `xcscr config show` lists all".to_owned();
    suggestion
        .as_ref()
        .map_or(hint, |key| format!("; did you mean `{key}`?"))
}
