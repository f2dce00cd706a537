//! MCAP files with messages of ROS 2.

use std::collections::BTreeMap;
use std::io::{Seek, Write};

use byteorder::LittleEndian;
use mcap::records::MessageHeader;
use mcap::{Compression, McapResult, WriteOptions, Writer};
use serde::Serialize;

use super::topics::BagTopic;

/// The CDR encapsulation header: little-endian, no options.
pub const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];
const LIBRARY: &str = concat!("xcscr/", env!("CARGO_PKG_VERSION"));

/// A file that is being written.
pub(super) struct RosWriter<W: Write + Seek> {
    writer: Writer<W>,
    channels: BTreeMap<BagTopic, u16>,
}

impl<W: Write + Seek> RosWriter<W> {
    /// Begins a file with its topics.
    pub fn begin(out: W, topics: &[BagTopic]) -> McapResult<Self> {
        let mut writer = WriteOptions::new()
            .compression(Some(Compression::Zstd))
            .compression_threads(0)
            .profile("ros2")
            .library(LIBRARY)
            .create(out)?;
        let mut channels = BTreeMap::new();
        for &topic in topics {
            let (interface, definition) = topic.interface();
            let schema = writer.add_schema(interface, "ros2msg", definition.as_bytes())?;
            let metadata = [("offered_qos_profiles".to_owned(), topic.qos().to_owned())].into();
            let channel = writer.add_channel(schema, topic.name(), "cdr", &metadata)?;
            channels.insert(topic, channel);
        }
        Ok(Self { writer, channels })
    }

    /// Writes an encoded message of a topic of the file.
    pub fn write(&mut self, topic: BagTopic, time_ns: u64, message: &[u8]) -> McapResult<()> {
        let header = MessageHeader {
            channel_id: self.channels[&topic],
            sequence: 0,
            log_time: time_ns,
            publish_time: time_ns,
        };
        self.writer.write_to_known_channel(&header, message)
    }

    /// Writes the index and returns the output.
    pub fn finish(mut self) -> McapResult<W> {
        self.writer.finish()?;
        Ok(self.writer.into_inner())
    }
}

/// Encodes a message with its encapsulation header; `Err` describes the fault.
pub fn encoded(message: &impl Serialize) -> Result<Vec<u8>, String> {
    let body = cdr_encoding::to_vec::<_, LittleEndian>(message);
    let body = body.map_err(|fault| fault.to_string())?;
    Ok([&ENCAPSULATION[..], &body].concat())
}
