//! The well-known messages, decoded to check them or to change their times and frames.

use foxglove::messages::{FrameTransforms, LaserScan, Log, SceneUpdate, Timestamp};
use foxglove::{Decode, Encode};

use super::{Message, Topic};

/// A decoded message of the schemas that viewers know.
pub(in crate::record) enum WellKnown {
    Frames(FrameTransforms),
    Scene(SceneUpdate),
    Scan(LaserScan),
    Log(Log),
}

impl WellKnown {
    /// Decodes a message of a topic; `None` for messages of our own. `Err` describes the fault.
    pub fn decode(topic: Topic, data: &[u8]) -> Result<Option<Self>, String> {
        let message = match topic.message() {
            Message::Frames => Self::Frames(decoded(data)?),
            Message::Scene => Self::Scene(decoded(data)?),
            Message::Scan => Self::Scan(decoded(data)?),
            Message::Log => Self::Log(decoded(data)?),
            Message::Own(..) => return Ok(None),
        };
        Ok(Some(message))
    }

    /// Encodes the message.
    pub fn encode(&self) -> Vec<u8> {
        match self {
            Self::Frames(frames) => encoded(frames),
            Self::Scene(scene) => encoded(scene),
            Self::Scan(scan) => encoded(scan),
            Self::Log(line) => encoded(line),
        }
    }

    /// Returns all times in the message.
    pub fn times(&mut self) -> Vec<&mut Timestamp> {
        match self {
            Self::Frames(frames) => {
                let frames = frames.transforms.iter_mut();
                frames
                    .filter_map(|frame| frame.timestamp.as_mut())
                    .collect()
            }
            Self::Scene(scene) => {
                let entities = scene.entities.iter_mut();
                entities
                    .filter_map(|entity| entity.timestamp.as_mut())
                    .collect()
            }
            Self::Scan(scan) => scan.timestamp.as_mut().into_iter().collect(),
            Self::Log(line) => line.timestamp.as_mut().into_iter().collect(),
        }
    }

    /// Returns all frame names in the message.
    pub fn frames(&mut self) -> Vec<&mut String> {
        match self {
            Self::Frames(frames) => {
                let frames = frames.transforms.iter_mut();
                let both = frames.flat_map(|f| [&mut f.parent_frame_id, &mut f.child_frame_id]);
                both.collect()
            }
            Self::Scene(scene) => {
                let entities = scene.entities.iter_mut();
                entities.map(|entity| &mut entity.frame_id).collect()
            }
            Self::Scan(scan) => vec![&mut scan.frame_id],
            Self::Log(_) => Vec::new(),
        }
    }
}

/// Decodes a message; `Err` describes the fault.
pub(in crate::record) fn decoded<M: Decode>(data: &[u8]) -> Result<M, String> {
    M::decode(data).map_err(|fault| fault.to_string())
}

/// Encodes a message.
pub(in crate::record) fn encoded(message: &impl Encode) -> Vec<u8> {
    let mut bytes = Vec::new();
    message
        .encode(&mut bytes)
        .expect("a vector has room for any message");
    bytes
}
