//! The topics of a recording: one file, one message type and one schema per topic.
//!
//! After a seek, a viewer gets only the last message of each topic. Data that changes at different
//! times therefore has separate topics, and every message is complete in itself.

pub(super) mod caption;
pub(super) mod estimate;
pub(super) mod log;
pub(super) mod maze;
pub(super) mod odometry;
pub mod percept;
pub(super) mod policy;
pub(super) mod robot;
pub(super) mod rule;
pub(super) mod scan;
mod scene;
pub(super) mod trail;
pub(super) mod transforms;
pub(super) mod values;

pub use estimate::Ellipse;
pub(super) use scene::size_m;

use std::sync::LazyLock;

use foxglove::messages::{FrameTransforms, Grid, LaserScan, Log, Odometry, SceneUpdate};
use foxglove::{Encode, Schema};
use strum::VariantArray;

use super::event::{self, schema};

/// A topic of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, VariantArray)]
pub enum Topic {
    /// `/tf`: the frames of the robot.
    Transforms,
    /// `/tf_static`: the frame of the grid, once.
    GridFrame,
    /// `/ground_truth`: the true pose and speeds.
    GroundTruth,
    /// `/estimate`: the estimated pose and its covariance, if the robot estimates its pose.
    Estimate,
    /// `/scene/maze`: floor, walls, start and goals, once.
    Maze,
    /// `/scene/robot`: the robot's body, once; `/tf` moves it.
    Robot,
    /// `/scene/policy`: the best actions of each cell, as they are learned.
    Policy,
    /// `/values`: the learned values and best actions of each cell, as a grid.
    Values,
    /// `/scene/trail`: the robot's trajectory in this episode, after each step.
    Trail,
    /// `/contact`: the start and the end of a wall contact.
    Contact,
    /// `/step`: a step, at the time when its outcome is known.
    Step,
    /// `/begin`: the start of an episode.
    Begin,
    /// `/episode`: the figures of an episode, at its end.
    Episode,
    /// `/curve`: the learning curve so far.
    Curve,
    /// `/log`: events as text.
    Log,
    /// `/scene/caption`: the caption.
    Caption,
    /// `/rule`: why an action was selected, at the time of the decision.
    Rule,
    /// `/scene/rule`: the content of `/rule` as text above the robot.
    RuleText,
    /// `/scene/percept`: the cell states that the robot perceives, and the estimated pose if the
    /// robot estimates its pose, at each decision.
    Percept,
    /// `/localisation`: the uncertainty and the error of the estimated pose, if the robot estimates its
    /// pose.
    Localisation,
    /// `/scan`: the measurements of the lidar beams, if they are recorded.
    Scan,
}

/// The recordings that have a topic.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Scope {
    /// The recordings of the run and of episodes: events that happen at most once per step.
    Both,
    /// The recordings of episodes only.
    Episode,
    /// The recordings of episodes, if the robot estimates its pose.
    Sensed,
    /// As [`Sensed`](Self::Sensed), if the lidar beams are recorded.
    Beams,
}

/// The message type of a topic: a well-known message as protobuf, or a fact as JSON.
#[derive(Clone, Copy)]
enum Kind {
    Frames,
    Grid,
    Odometry,
    Scene,
    Scan,
    Log,
    /// A fact, by the name of its schema.
    Fact(&'static str, fn(&str) -> Schema),
}

impl Topic {
    /// All topics, in the order of declaration.
    pub const ALL: &[Self] = Self::VARIANTS;

    /// Returns the topic's name in the file, the recordings that have it, and its message type.
    fn entry(self) -> (&'static str, Scope, Kind) {
        use Kind::Fact;
        match self {
            Self::Transforms => ("/tf", Scope::Episode, Kind::Frames),
            Self::GridFrame => ("/tf_static", Scope::Both, Kind::Frames),
            Self::GroundTruth => ("/ground_truth", Scope::Episode, Kind::Odometry),
            Self::Estimate => ("/estimate", Scope::Sensed, Kind::Odometry),
            Self::Maze => ("/scene/maze", Scope::Both, Kind::Scene),
            Self::Robot => ("/scene/robot", Scope::Episode, Kind::Scene),
            Self::Policy => ("/scene/policy", Scope::Both, Kind::Scene),
            Self::Values => ("/values", Scope::Both, Kind::Grid),
            Self::Trail => ("/scene/trail", Scope::Both, Kind::Scene),
            Self::Contact => (
                "/contact",
                Scope::Episode,
                Fact("xcscr.Contact", schema::<event::Contact>),
            ),
            Self::Step => (
                "/step",
                Scope::Both,
                Fact("xcscr.Step", schema::<event::StepOutcome>),
            ),
            Self::Begin => (
                "/begin",
                Scope::Both,
                Fact("xcscr.Begin", schema::<event::Begin>),
            ),
            Self::Episode => (
                "/episode",
                Scope::Both,
                Fact("xcscr.Episode", schema::<event::End>),
            ),
            Self::Curve => (
                "/curve",
                Scope::Episode,
                Fact("xcscr.Curve", schema::<event::Curve>),
            ),
            Self::Log => ("/log", Scope::Both, Kind::Log),
            Self::Caption => ("/scene/caption", Scope::Both, Kind::Scene),
            Self::Rule => (
                "/rule",
                Scope::Episode,
                Fact("xcscr.Rule", schema::<event::Decision>),
            ),
            Self::RuleText => ("/scene/rule", Scope::Episode, Kind::Scene),
            Self::Percept => ("/scene/percept", Scope::Episode, Kind::Scene),
            Self::Localisation => (
                "/localisation",
                Scope::Sensed,
                Fact("xcscr.Localisation", schema::<event::Localisation>),
            ),
            Self::Scan => ("/scan", Scope::Beams, Kind::Scan),
        }
    }

    /// Returns the topic's name in the file.
    pub fn name(self) -> &'static str {
        self.entry().0
    }

    /// Returns the topic of this name.
    pub fn named(name: &str) -> Option<Self> {
        let mut all = Self::ALL.iter().copied();
        all.find(|topic| topic.name() == name)
    }

    /// Returns the topics of an episode's file. `senses` adds those of a robot that estimates its
    /// pose, and `beams` those of recorded lidar beams.
    pub fn of_episode(senses: bool, beams: bool) -> Vec<Self> {
        Self::at(|scope| match scope {
            Scope::Both | Scope::Episode => true,
            Scope::Sensed => senses,
            Scope::Beams => senses && beams,
        })
    }

    /// Returns the topics of `run.mcap`.
    pub fn of_run() -> Vec<Self> {
        Self::at(|scope| scope == Scope::Both)
    }

    /// Returns the type of the topic's messages.
    fn kind(self) -> Kind {
        self.entry().2
    }

    /// Returns true if every complete recording with this topic has a message on it.
    pub(super) fn is_never_silent(self) -> bool {
        self.entry().1 != Scope::Beams
    }

    fn at(has: impl Fn(Scope) -> bool) -> Vec<Self> {
        let all = Self::ALL.iter().copied();
        all.filter(|topic| has(topic.entry().1)).collect()
    }

    /// Returns the schema of the topic's messages.
    pub(super) fn schema(self) -> &'static Schema {
        static SCHEMAS: LazyLock<Vec<Schema>> = LazyLock::new(|| {
            let all = Topic::ALL.iter();
            all.map(|topic| topic.defined()).collect()
        });
        &SCHEMAS[self as usize]
    }

    fn defined(self) -> Schema {
        let well_known = match self.kind() {
            Kind::Frames => FrameTransforms::get_schema(),
            Kind::Grid => Grid::get_schema(),
            Kind::Odometry => Odometry::get_schema(),
            Kind::Scene => SceneUpdate::get_schema(),
            Kind::Scan => LaserScan::get_schema(),
            Kind::Log => Log::get_schema(),
            Kind::Fact(name, schema) => return schema(name),
        };
        well_known.expect("well-known messages have a schema")
    }

    /// Returns the encoding of the topic's messages: `json` or `protobuf`.
    pub(super) fn message_encoding(self) -> &'static str {
        match self.schema().encoding.as_str() {
            "jsonschema" => "json",
            _ => "protobuf",
        }
    }
}

/// Rounds a number for protobuf messages to a multiple of 2^-12, which makes files a third smaller.
fn rounded(number: f64) -> f64 {
    to_parts(number, 4096.0)
}

/// Rounds a number for JSON messages to three decimals, for legibility.
pub fn decimal(number: f64) -> f64 {
    to_parts(number, 1000.0)
}

/// Rounds a number to a multiple of 1 / `parts`, never to minus zero.
pub(super) fn to_parts(number: f64, parts: f64) -> f64 {
    (number * parts).round() / parts + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rounded_number_is_never_minus_zero() {
        assert!(rounded(-1e-9).is_sign_positive());
        assert!(decimal(-1e-9).is_sign_positive());
        assert_eq!(rounded(0.3), 1229.0 / 4096.0);
        assert_eq!(decimal(-49.999_6), -50.0);
    }
}
