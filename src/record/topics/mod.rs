//! The topics of a recording: one file, one message type and one schema per topic.
//!
//! After a seek a viewer is given only the last message of each topic. So what changes at
//! different times has topics of its own, and every message is complete in itself.

pub(super) mod caption;
pub(super) mod contact;
pub(super) mod curve;
mod descriptor;
pub(super) mod episode;
pub(super) mod estimate;
pub(super) mod legend;
pub(super) mod log;
pub(super) mod maze;
pub(super) mod percept;
pub(super) mod policy;
pub(super) mod rays;
pub(super) mod robot;
pub(super) mod rule;
pub(super) mod scan;
mod scene;
mod schema;
pub(super) mod step;
pub(super) mod trail;
pub(super) mod transforms;
pub(super) mod values;

pub(super) use caption::Caption;
pub(super) use scene::{ESTIMATE, ROBOT, WORLD, timestamp};

use std::sync::LazyLock;

use foxglove::messages::{FrameTransforms, LaserScan, Log, SceneUpdate};
use foxglove::{Decode, Encode, Schema};
use strum::VariantArray;

use super::info::RecordingKind;
use schema::Object;

/// A topic of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, VariantArray)]
pub enum Topic {
    /// `/tf`: where the robot is, as many poses as it takes, up to two seconds in each message.
    Transforms,
    /// `/scene/maze`: floor, walls, start and goals, once.
    Maze,
    /// `/scene/robot`: what the robot looks like, once; `/tf` moves it.
    Robot,
    /// `/scene/policy`: the best actions of each cell, as they are learned.
    Policy,
    /// `/values`: the greatest value of each cell as colour on the floor, as it is learned.
    Values,
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
    /// `/scene/percept`: what the robot perceives of the cells around it, and where one that only
    /// senses believes to be, when it decides.
    Percept,
    /// `/scene/values`: what cells are worth as columns, when an episode was learned.
    Landscape,
    /// `/estimate`: where a robot that only senses believes to be, and how much it is mistaken.
    Estimate,
    /// `/scan`: what the beams of the lidar measured, if they are recorded.
    Scan,
    /// `/ended`: the number of an episode that is over. Viewers that plot figures by episode want
    /// the number on another topic than the figures.
    Ended,
}

/// Which recordings have a topic.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    /// That of the run and those of episodes: what happens once per step or more rarely.
    Both,
    /// Only that of the run.
    Run,
    /// Only those of episodes.
    Episode,
    /// Those of episodes, if the robot senses where it is.
    Sensed,
    /// The same, if the beams of its lidar are recorded.
    Beams,
}

/// What the messages of a topic are: a well-known message as protobuf, or one of our own as JSON.
#[derive(Debug, Clone, Copy)]
pub(super) enum Message {
    Frames,
    Scene,
    Scan,
    Log,
    /// Its fields.
    Own(fn() -> Object),
}

impl Topic {
    /// Every topic, in the order of their declaration.
    pub const ALL: &[Self] = Self::VARIANTS;

    /// The topic's name in the file, which files have it, and what it consists of.
    fn entry(self) -> (&'static str, Place, Message) {
        match self {
            Self::Transforms => ("/tf", Place::Episode, Message::Frames),
            Self::Maze => ("/scene/maze", Place::Both, Message::Scene),
            Self::Robot => ("/scene/robot", Place::Episode, Message::Scene),
            Self::Policy => ("/scene/policy", Place::Both, Message::Scene),
            Self::Values => ("/values", Place::Both, Message::Scene),
            Self::Trail => ("/scene/trail", Place::Both, Message::Scene),
            Self::Contact => ("/contact", Place::Episode, Message::Own(contact::schema)),
            Self::Step => ("/step", Place::Both, Message::Own(step::schema)),
            Self::Episode => ("/episode", Place::Both, Message::Own(episode::schema)),
            Self::Curve => ("/curve", Place::Episode, Message::Own(curve::schema)),
            Self::Log => ("/log", Place::Both, Message::Log),
            Self::Caption => ("/scene/caption", Place::Both, Message::Scene),
            Self::Rule => ("/rule", Place::Episode, Message::Own(rule::schema)),
            Self::RuleText => ("/scene/rule", Place::Episode, Message::Scene),
            Self::Percept => ("/scene/percept", Place::Episode, Message::Scene),
            Self::Landscape => ("/scene/values", Place::Both, Message::Scene),
            Self::Estimate => ("/estimate", Place::Sensed, Message::Own(estimate::schema)),
            Self::Scan => ("/scan", Place::Beams, Message::Scan),
            Self::Ended => ("/ended", Place::Run, Message::Own(episode::schema_of_ended)),
        }
    }

    /// The topic's name in the file.
    pub fn name(self) -> &'static str {
        self.entry().0
    }

    /// The topic of this name.
    pub fn named(name: &str) -> Option<Self> {
        let mut all = Self::ALL.iter().copied();
        all.find(|topic| topic.name() == name)
    }

    /// The topics of an episode's file; more when the robot senses where it is, and when the beams
    /// of its lidar are recorded.
    pub fn of_episode(senses: bool, beams: bool) -> Vec<Self> {
        Self::at(|place| match place {
            Place::Both | Place::Episode => true,
            Place::Sensed => senses,
            Place::Beams => senses && beams,
            Place::Run => false,
        })
    }

    /// The topics of `run.mcap`.
    pub fn of_run() -> Vec<Self> {
        Self::at(|place| matches!(place, Place::Both | Place::Run))
    }

    /// What its messages are.
    pub(super) fn message(self) -> Message {
        self.entry().2
    }

    /// Does only a robot that senses have it? Layouts show it nevertheless: viewers leave out what a
    /// recording lacks.
    pub fn is_of_senses(self) -> bool {
        matches!(self.entry().1, Place::Sensed | Place::Beams)
    }

    fn at(has: impl Fn(Place) -> bool) -> Vec<Self> {
        let all = Self::ALL.iter().copied();
        all.filter(|topic| has(topic.entry().1)).collect()
    }

    /// The schema of the topic's messages in such a recording. Those of our own tell what each
    /// field means in the recording of a run and in its highlights, and only its type in that of an
    /// episode, of which there are many.
    pub(super) fn schema(self, of: RecordingKind) -> &'static Schema {
        static SCHEMAS: LazyLock<[Vec<Schema>; 2]> = LazyLock::new(|| {
            [false, true].map(|explained| {
                let all = Topic::ALL.iter();
                all.map(|topic| topic.defined(explained)).collect()
            })
        });
        let explained = of.episode().is_none();
        &SCHEMAS[usize::from(explained)][self as usize]
    }

    fn defined(self, explained: bool) -> Schema {
        let well_known = match self.message() {
            Message::Frames => FrameTransforms::get_schema(),
            Message::Scene => SceneUpdate::get_schema(),
            Message::Scan => LaserScan::get_schema(),
            Message::Log => Log::get_schema(),
            Message::Own(fields) => return fields().schema(explained),
        };
        descriptor::short(&well_known.expect("well-known messages have a schema"))
    }

    /// What is wrong with a message, as far as the topic's schema tells.
    pub(super) fn fault(self, data: &[u8]) -> Option<String> {
        fn undecodable<M: Decode>(data: &[u8]) -> Option<String> {
            let fault = M::decode(data).err()?;
            Some(format!("is not what its schema says: {fault}"))
        }
        match self.message() {
            Message::Frames => undecodable::<FrameTransforms>(data),
            Message::Scene => undecodable::<SceneUpdate>(data),
            Message::Scan => undecodable::<LaserScan>(data),
            Message::Log => undecodable::<Log>(data),
            Message::Own(fields) => fields().fault(data),
        }
    }

    /// How the topic's messages are encoded: `json` or `protobuf`.
    pub(super) fn message_encoding(self) -> &'static str {
        match self.schema(RecordingKind::Run).encoding.as_str() {
            "jsonschema" => "json",
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
    fn a_rounded_number_is_never_minus_zero() {
        assert!(rounded(-1e-9).is_sign_positive());
        assert!(decimal(-1e-9).is_sign_positive());
        assert_eq!(rounded(0.3), 1229.0 / 4096.0);
        assert_eq!(decimal(-49.999_6), -50.0);
    }
}
