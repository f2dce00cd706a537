//! Readers of settings, for refusing settings without effect.

use std::fmt;
use std::sync::LazyLock;

use super::resolve::Resolved;
use super::settings::Settings;
use super::settings_error::{SettingOrigin, SettingsError};
use crate::agent::{Estimator, Method, Sharing};
use xcscr_robot::arena::{ArenaKind, Localisation};
use xcscr_robot::sensor::Sensor;

/// The parts of the program that read a setting.
#[derive(Debug, Clone)]
pub enum ReadBy {
    /// Every run.
    Everything,
    /// Some of the methods, while they learn.
    Methods(Vec<Reader>),
    /// The robot in physics.
    Robot,
    /// The robot in physics that estimates its pose.
    SensingRobot,
    /// The robot in physics that is given its true pose with some noise.
    GroundTruthRobot,
    /// The robot in physics with ground-truth percepts. Robots with sensed percepts always estimate their pose.
    RobotWithTruePercepts,
}

/// A method that reads a setting, always or only with another setting.
#[derive(Debug, Clone, Copy)]
pub struct Reader {
    method: Method,
    condition: Option<Condition>,
}

/// A condition on the settings under which a method reads a setting.
#[derive(Debug, Clone, Copy)]
struct Condition {
    /// The condition as an argument of `--set`.
    text: &'static str,
    holds: fn(&Settings) -> bool,
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

const XCSAM: [Method; 1] = [Method::Xcsam];
const STANDARD: [Method; 2] = [Method::Xcs, Method::Xcsam];
const ADAPTED_EVEN: [Method; 1] = [Method::AdaptedEven];
const ADAPTED_DISCOUNTED: [Method; 1] = [Method::AdaptedDiscounted];
const ADAPTED: [Method; 2] = [Method::AdaptedEven, Method::AdaptedDiscounted];
const XCSCR_ALONE: [Method; 1] = [Method::Xcscr];
const COEVOLVED: [Method; 1] = [Method::XcscrCoevolved];
const XCSCR: [Method; 2] = [Method::Xcscr, Method::XcscrCoevolved];
const XCS: [Method; 6] = [
    Method::Xcs,
    Method::Xcsam,
    Method::AdaptedEven,
    Method::AdaptedDiscounted,
    Method::Xcscr,
    Method::XcscrCoevolved,
];
const XCSCR_PLUS: [Method; 1] = [Method::XcscrPlus];
const COMPOSED: [Method; 2] = [Method::XcscrPlus, Method::RMax];
const SARSA_LAMBDA: [Method; 1] = [Method::SarsaLambda];
const DYNA_Q: [Method; 1] = [Method::DynaQ];
const VALUE_TABLES: [Method; 3] = [Method::QLearning, Method::SarsaLambda, Method::DynaQ];

const UNPLANNED: Condition = Condition {
    text: "plus.planned_exploration=false",
    holds: |all| !all.plus.planned_exploration,
};
const EVEN: Condition = Condition {
    text: "reward.sharing=even",
    holds: |all| all.reward.sharing == Sharing::Even,
};
const DISCOUNTED: Condition = Condition {
    text: "reward.sharing=discounted",
    holds: |all| all.reward.sharing == Sharing::Discounted,
};
const ONE_RATE: Condition = Condition {
    text: "reward.learning_rate_switching=false",
    holds: |all| !all.reward.learning_rate_switching,
};
const ALTERNATING: Condition = Condition {
    text: "episode.alternate=true",
    holds: |all| all.episode.alternate,
};
const ON_PERCEPTS: Condition = Condition {
    text: "plus.estimator=auto|percept",
    holds: |all| all.plus.estimator != Estimator::Map,
};
const ON_A_MAP: Condition = Condition {
    text: "plus.estimator=auto|map",
    holds: |all| all.plus.estimator != Estimator::Percept,
};

/// Lists methods that read a setting, some of them only under a condition.
macro_rules! methods {
    ($($methods:ident $(if $condition:ident)?),*) => {
        ReadBy::Methods([$(readers(&$methods, None$(.or(Some($condition)))?)),*].concat())
    };
}

/// The readers of each setting, by its full name. A section pattern covers all settings without their own row.
static TABLE: LazyLock<Vec<(&str, ReadBy)>> = LazyLock::new(|| {
    use ReadBy::{Everything, GroundTruthRobot, Robot, RobotWithTruePercepts, SensingRobot};
    vec![
        ("arena.*", Everything),
        ("sensor.*", Everything),
        ("reward.step_threshold", Everything),
        ("reward.step_threshold_from_maze", Everything),
        ("reward.goal", ReadBy::Methods(readers(Method::ALL, None))),
        (
            "reward.step",
            methods![STANDARD, XCSCR, COMPOSED, VALUE_TABLES],
        ),
        (
            "reward.collision",
            methods![STANDARD, XCSCR, COMPOSED if ON_PERCEPTS, VALUE_TABLES],
        ),
        ("reward.failure", methods![XCS]),
        ("reward.xcs_payment", methods![STANDARD]),
        ("reward.xcs_step_limit", methods![STANDARD]),
        ("reward.stack_evolution", methods![ADAPTED, XCSCR]),
        (
            "reward.gamma",
            methods![STANDARD, ADAPTED_DISCOUNTED, XCSCR if DISCOUNTED, COMPOSED, VALUE_TABLES],
        ),
        (
            "reward.even_constant",
            methods![ADAPTED_EVEN, XCSCR if EVEN],
        ),
        ("reward.*", methods![XCSCR]),
        (
            "episode.*",
            methods![XCS, COMPOSED if UNPLANNED, VALUE_TABLES],
        ),
        ("xcs.population_size", methods![XCS, XCSCR_PLUS]),
        (
            "xcs.beta",
            methods![STANDARD, ADAPTED, XCSCR_ALONE if ONE_RATE, COEVOLVED],
        ),
        ("xcs.ga_clock", methods![XCS if ALTERNATING]),
        ("xcs.zeta", methods![XCSAM]),
        ("xcs.*", methods![XCS]),
        ("plus.estimator", methods![COMPOSED]),
        ("plus.*", methods![COMPOSED if ON_PERCEPTS]),
        ("map.*", methods![COMPOSED if ON_A_MAP]),
        ("tabular.alpha", methods![VALUE_TABLES]),
        ("tabular.lambda", methods![SARSA_LAMBDA]),
        ("tabular.replays", methods![DYNA_Q]),
        ("physics.localisation", RobotWithTruePercepts),
        ("physics.position_noise_m", GroundTruthRobot),
        ("physics.heading_noise_rad", GroundTruthRobot),
        ("physics.bumper.*", SensingRobot),
        ("physics.encoders.*", SensingRobot),
        ("physics.estimator.*", SensingRobot),
        ("physics.faults.*", SensingRobot),
        ("physics.gyro.*", SensingRobot),
        ("physics.lidar.*", SensingRobot),
        ("physics.*", Robot),
    ]
});

fn readers(methods: &[Method], condition: Option<Condition>) -> Vec<Reader> {
    let reader = |&method: &Method| Reader { method, condition };
    methods.iter().map(reader).collect()
}

impl ReadBy {
    /// Returns the readers of the setting with this full name; `None` if there is no such setting.
    pub fn of(key: &str) -> Option<&'static Self> {
        Some(&TABLE[row_of(key)?].1)
    }

    /// Returns true if the verb after the list of readers is plural.
    fn are_several(&self) -> bool {
        matches!(self, Self::Methods(readers) if readers.len() > 1)
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
        let words = match self {
            Self::Everything => "every run",
            Self::Methods(readers) => return write_readers(readers, f),
            Self::Robot => "the arena `physics`",
            Self::SensingRobot => {
                "a robot in `physics` that estimates its pose (percept `lidar...`, or `physics.localisation=estimated`)"
            }
            Self::GroundTruthRobot => {
                "a robot in `physics` that does not estimate its pose (another percept than `lidar...`)"
            }
            Self::RobotWithTruePercepts => {
                "a robot in `physics` with another percept than `lidar...`"
            }
        };
        f.write_str(words)
    }
}

fn write_readers(readers: &[Reader], f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let always = readers.iter().all(|reader| reader.condition.is_none());
    if always && readers.len() == Method::ALL.len() {
        return f.write_str("every method");
    }
    let words = readers.iter().map(|reader| {
        let condition = reader.condition.map(|one| format!(" with `{}`", one.text));
        format!(
            "`{}`{}",
            reader.method.name(),
            condition.unwrap_or_default()
        )
    });
    f.write_str(&words.collect::<Vec<_>>().join(", "))
}

impl Scope<'_> {
    /// Returns true if the setting with this full name can have an effect.
    pub fn reads(&self, key: &str) -> bool {
        let is_driven = self.arena == ArenaKind::Physics;
        let is_sensed = self.sensor.is_sensed();
        let estimates = is_sensed || self.settings.physics.localisation == Localisation::Estimated;
        ReadBy::of(key).is_some_and(|readers| match readers {
            ReadBy::Everything => true,
            ReadBy::Methods(readers) => readers.iter().any(|reader| {
                let condition = reader.condition;
                Some(reader.method) == self.method
                    && condition.is_none_or(|condition| (condition.holds)(self.settings))
            }),
            ReadBy::Robot => is_driven,
            ReadBy::SensingRobot => is_driven && estimates,
            ReadBy::GroundTruthRobot => is_driven && !estimates,
            ReadBy::RobotWithTruePercepts => is_driven && !is_sensed,
        })
    }

    /// Explains why the setting with this full name has no effect, and what reads it.
    pub fn why_unread(&self, key: &str) -> String {
        let Some(readers) = ReadBy::of(key) else {
            return "there is no such setting".to_owned();
        };
        let verb = if readers.are_several() { "do" } else { "does" };
        let who = match (readers, self.method) {
            (ReadBy::Methods(_), None) => {
                return "the policy only drives here, and does not learn".to_owned();
            }
            (ReadBy::Methods(_), Some(method)) => format!("the method `{}`", method.name()),
            _ if self.arena == ArenaKind::Grid => "the arena `grid`".to_owned(),
            _ => format!("a robot with the percept `{}`", self.sensor.name()),
        };
        format!("{who} does not read it; {readers} {verb}")
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
        assert!(words("map.feels_bumps").ends_with("`r-max` with `plus.estimator=auto|map`"));
    }
}
