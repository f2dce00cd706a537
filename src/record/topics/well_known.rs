//! The well-known messages, decoded to check them.

use foxglove::Decode;
use foxglove::messages::{FrameTransforms, LaserScan, Log, SceneUpdate, Timestamp};

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
}

/// Decodes a message; `Err` describes the fault.
pub(in crate::record) fn decoded<M: Decode>(data: &[u8]) -> Result<M, String> {
    M::decode(data).map_err(|fault| fault.to_string())
}
