//! The topics of a recording: one file, one message type and one schema per topic.
//!
//! After a seek a viewer is given only the last message of each topic. So what changes at
//! different times has topics of its own, and every message is complete in itself.

pub(super) mod caption;
pub(super) mod contact;
pub(super) mod curve;
pub(super) mod episode;
pub(super) mod estimate;
pub(super) mod log;
pub(super) mod maze;
pub(super) mod percept;
pub(super) mod policy;
pub(super) mod robot;
pub(super) mod rule;
pub(super) mod scan;
mod scene;
mod schema;
pub(super) mod step;
pub(super) mod trail;
pub(super) mod transforms;
pub(super) mod worth;

pub(super) use scene::timestamp;

use foxglove::messages::{FrameTransforms, Grid, LaserScan, Log, SceneUpdate};
use foxglove::{Encode, Schema};

/// A topic of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Topic {
    /// `/tf`: where the robot is, as many poses as it takes, up to a second in each message.
    Transforms,
    /// `/scene/maze`: floor, walls, start and goals, once.
    Maze,
    /// `/scene/robot`: what the robot looks like, once; `/tf` moves it.
    Robot,
    /// `/scene/policy`: the best actions of each cell, as they are learned.
    Policy,
    /// `/worth`: the greatest worth of each cell as a heat map, as it is learned.
    Worth,
    /// `/scene/trail`: the way that the robot took in this episode, after each step.
    Trail,
    /// `/contact`: a hit, and its end.
    Contact,
    /// `/step`: a step, at the moment at which its outcome is known.
    Step,
    /// `/episode`: the figures of an episode, at its end.
    Episode,
    /// `/curve`: the learning curve up to here.
    Curve,
    /// `/log`: what happened, in words.
    Log,
    /// `/scene/caption`: what is shown, in words.
    Caption,
    /// `/rule`: why an action is taken, at the moment of its decision.
    Rule,
    /// `/scene/rule`: the same over the robot.
    RuleText,
    /// `/scene/percept`: what the robot perceives of the cells around it, when it decides.
    Percept,
    /// `/scene/worth`: what cells are worth as columns, when an episode was learned.
    Landscape,
    /// `/estimate`: where a robot that only senses believes to be, and how much it is mistaken.
    Estimate,
    /// `/scene/estimate`: the same as a picture.
    Ghost,
    /// `/scan`: what the beams of the lidar measured, if they are recorded.
    Scan,
    /// `/ended`: the number of an episode that is over. Viewers that plot figures by episode want
    /// the number on another topic than the figures.
    Ended,
}

impl Topic {
    /// Every topic, in the order of their declaration.
    pub const ALL: [Self; 20] = [
        Self::Transforms,
        Self::Maze,
        Self::Robot,
        Self::Policy,
        Self::Worth,
        Self::Trail,
        Self::Contact,
        Self::Step,
        Self::Episode,
        Self::Curve,
        Self::Log,
        Self::Caption,
        Self::Rule,
        Self::RuleText,
        Self::Percept,
        Self::Landscape,
        Self::Estimate,
        Self::Ghost,
        Self::Scan,
        Self::Ended,
    ];
    /// How many topics, the first ones, an episode has of a robot that is told where it is.
    const TOLD: usize = 16;
    /// The same of one that senses, but whose beams are not recorded.
    const SENSED: usize = 18;
    /// The same with its beams.
    const SCANNED: usize = 19;
    /// The topics of `run.mcap`: what happens once per step or more rarely.
    pub const OF_RUN: [Self; 10] = [
        Self::Maze,
        Self::Policy,
        Self::Worth,
        Self::Trail,
        Self::Step,
        Self::Episode,
        Self::Log,
        Self::Caption,
        Self::Landscape,
        Self::Ended,
    ];

    /// The topics of an episode's file; more when the robot senses where it is, and when the beams
    /// of its lidar are recorded.
    pub fn of_episode(senses: bool, beams: bool) -> &'static [Self] {
        match (senses, beams) {
            (true, true) => &Self::ALL[..Self::SCANNED],
            (true, false) => &Self::ALL[..Self::SENSED],
            (false, _) => &Self::ALL[..Self::TOLD],
        }
    }

    /// Does only a robot that senses have it? Layouts show it nevertheless: viewers leave out what a
    /// recording lacks.
    pub fn is_of_senses(self) -> bool {
        (Self::TOLD..Self::SCANNED).contains(&(self as usize))
    }

    /// The topic's name in the file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Transforms => "/tf",
            Self::Maze => "/scene/maze",
            Self::Robot => "/scene/robot",
            Self::Policy => "/scene/policy",
            Self::Worth => "/worth",
            Self::Trail => "/scene/trail",
            Self::Contact => "/contact",
            Self::Step => "/step",
            Self::Episode => "/episode",
            Self::Curve => "/curve",
            Self::Log => "/log",
            Self::Caption => "/scene/caption",
            Self::Rule => "/rule",
            Self::RuleText => "/scene/rule",
            Self::Percept => "/scene/percept",
            Self::Landscape => "/scene/worth",
            Self::Estimate => "/estimate",
            Self::Ghost => "/scene/estimate",
            Self::Scan => "/scan",
            Self::Ended => "/ended",
        }
    }

    /// The topic of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|topic| topic.name() == name)
    }

    /// The schema of the topic's messages: well-known ones as protobuf, our own as JSON.
    pub(super) fn schema(self) -> Schema {
        let well_known = match self {
            Self::Transforms => FrameTransforms::get_schema(),
            Self::Maze
            | Self::Robot
            | Self::Policy
            | Self::Trail
            | Self::Caption
            | Self::RuleText
            | Self::Percept
            | Self::Landscape
            | Self::Ghost => SceneUpdate::get_schema(),
            Self::Worth => Grid::get_schema(),
            Self::Log => Log::get_schema(),
            Self::Scan => LaserScan::get_schema(),
            Self::Contact => return contact::schema(),
            Self::Step => return step::schema(),
            Self::Rule => return rule::schema(),
            Self::Episode => return episode::schema(),
            Self::Curve => return curve::schema(),
            Self::Ended => return episode::schema_of_ended(),
            Self::Estimate => return estimate::schema(),
        };
        well_known.expect("well-known messages have a schema")
    }

    /// How the topic's messages are encoded: `json` or `protobuf`.
    pub(super) fn message_encoding(self) -> &'static str {
        match self {
            Self::Contact
            | Self::Step
            | Self::Rule
            | Self::Episode
            | Self::Curve
            | Self::Ended
            | Self::Estimate => "json",
            _ => "protobuf",
        }
    }
}

/// A number as protobuf messages carry it: a multiple of 2^-12, so that files shrink by a third.
fn rounded(number: f64) -> f64 {
    (number * 4096.0).round() / 4096.0 + 0.0
}

/// A number as JSON messages carry it: three decimals, which is short to read.
fn decimal(number: f64) -> f64 {
    (number * 1000.0).round() / 1000.0 + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn topics_are_listed_in_the_order_of_their_numbers() {
        for (number, topic) in Topic::ALL.into_iter().enumerate() {
            assert_eq!(topic as usize, number);
        }
    }

    #[test]
    fn a_rounded_number_is_never_minus_zero() {
        assert!(rounded(-1e-9).is_sign_positive());
        assert!(decimal(-1e-9).is_sign_positive());
        assert_eq!(rounded(0.3), 1229.0 / 4096.0);
        assert_eq!(decimal(-49.999_6), -50.0);
    }
}
