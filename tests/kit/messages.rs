//! The messages of recordings.

use foxglove::Decode;
use foxglove::messages::SceneUpdate;
use serde_json::Value;
use xcscr::record::reader::{Message, Recording};

/// Returns all messages of a recording.
pub fn messages(recording: &Recording) -> impl Iterator<Item = Message> {
    recording.messages().map(|message| message.unwrap())
}

/// Returns the messages of a topic.
pub fn on<'a>(recording: &'a Recording, topic: &'a str) -> impl Iterator<Item = Message> + 'a {
    messages(recording).filter(move |message| message.topic() == topic)
}

/// Returns the times in nanoseconds and the contents of the messages of a JSON topic.
pub fn said(recording: &Recording, topic: &str) -> Vec<(u64, Value)> {
    on(recording, topic)
        .map(|message| (message.time_ns, message.json().unwrap()))
        .collect()
}

/// Returns the scene of a message.
pub fn scene(message: &Message) -> SceneUpdate {
    SceneUpdate::decode(message.data.as_slice()).unwrap()
}

/// Returns the number of messages of a topic, as the index of the recording says.
pub fn count(recording: &Recording, topic: &str) -> u64 {
    let topics = recording.topics();
    let of_topic = topics.iter().filter(|one| one.name == topic);
    of_topic.map(|one| one.messages).sum()
}
