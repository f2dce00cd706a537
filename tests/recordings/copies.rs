//! Copies of recordings that differ from them as a test wants it.

use std::collections::BTreeMap;
use std::io::Cursor;

use crate::kit::messages::messages;
use mcap::records::{MessageHeader, Metadata};
use mcap::{Attachment, WriteOptions};
use xcscr::record::EPOCH_NS;
use xcscr::record::reader::{Message, Recording, TopicInfo};

/// What a copy of a recording is made of.
pub struct Parts {
    pub run: BTreeMap<String, String>,
    pub attached: BTreeMap<String, Vec<u8>>,
    pub topics: Vec<TopicInfo>,
    pub messages: Vec<Message>,
}

impl Parts {
    pub fn of(recording: &Recording) -> Self {
        let attached = recording.attachments().iter();
        Self {
            run: recording.metadata("run").unwrap().clone(),
            attached: attached
                .map(|one| (one.name.clone(), one.data.clone()))
                .collect(),
            topics: recording.topics(),
            messages: messages(recording).collect(),
        }
    }

    pub fn messages_on(&mut self, topic: &str) -> impl Iterator<Item = &mut Message> {
        let all = self.messages.iter_mut();
        all.filter(move |message| message.topic() == topic)
    }

    /// Writes the copy.
    pub fn write(&self, options: WriteOptions) -> Vec<u8> {
        let mut writer = options.create(Cursor::new(Vec::new())).unwrap();
        self.write_into(&mut writer);
        writer.finish().unwrap();
        writer.into_inner().into_inner()
    }

    fn write_into(&self, writer: &mut mcap::Writer<Cursor<Vec<u8>>>) {
        let (name, metadata) = ("run".to_owned(), self.run.clone());
        writer.write_metadata(&Metadata { name, metadata }).unwrap();
        // In the order of the program: world.json, config.json.
        for (name, data) in self.attached.iter().rev() {
            let attachment = Attachment {
                log_time: 0,
                create_time: 0,
                name: name.clone(),
                media_type: "application/json".to_owned(),
                data: data.into(),
            };
            writer.attach(&attachment).unwrap();
        }
        let mut channels = BTreeMap::new();
        for topic in &self.topics {
            let language = match topic.encoding.as_str() {
                "json" => "jsonschema",
                other => other,
            };
            let schema = writer.add_schema(&topic.schema, language, &topic.schema_data);
            let none = BTreeMap::new();
            let channel = writer.add_channel(schema.unwrap(), &topic.name, &topic.encoding, &none);
            channels.insert(topic.name.as_str(), channel.unwrap());
        }
        for message in &self.messages {
            let header = MessageHeader {
                channel_id: channels[message.topic()],
                sequence: 0,
                log_time: EPOCH_NS.saturating_add(message.time_ns),
                publish_time: EPOCH_NS.saturating_add(message.time_ns),
            };
            writer
                .write_to_known_channel(&header, &message.data)
                .unwrap();
        }
    }
}

/// Merges recordings as other programs do: with all attachments, and with a channel of each recording for each topic.
pub fn merged(all: &[Parts]) -> Vec<u8> {
    let mut writer = WriteOptions::new().create(Cursor::new(Vec::new())).unwrap();
    all.iter().for_each(|parts| parts.write_into(&mut writer));
    writer.finish().unwrap();
    writer.into_inner().into_inner()
}
