//! MCAP files with messages of ROS 2.

use std::io::{Seek, Write};

use byteorder::LittleEndian;
use mcap::records::MessageHeader;
use mcap::{Compression, McapResult, WriteOptions, Writer};
use serde::Serialize;

use super::schemas::Interface;

/// The CDR encapsulation header: little-endian, no options.
pub const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];
const LIBRARY: &str = concat!("xcscr/", env!("CARGO_PKG_VERSION"));

/// A topic: its name, its type and its quality of service.
pub type RosTopic = (&'static str, Interface, &'static str);

/// A file that is being written. Its topics have the numbers of their declaration.
pub struct RosWriter<W: Write + Seek> {
    writer: Writer<W>,
    channels: Vec<u16>,
}

impl<W: Write + Seek> RosWriter<W> {
    /// Begins a file with its topics.
    pub fn begin(out: W, topics: &[RosTopic]) -> McapResult<Self> {
        let mut writer = WriteOptions::new()
            .compression(Some(Compression::Zstd))
            .compression_threads(0)
            .profile("ros2")
            .library(LIBRARY)
            .create(out)?;
        let mut channels = Vec::new();
        for (topic, (name, definition), qos) in topics {
            let schema = writer.add_schema(name, "ros2msg", definition.as_bytes())?;
            let metadata = [("offered_qos_profiles".to_owned(), (*qos).to_owned())].into();
            channels.push(writer.add_channel(schema, topic, "cdr", &metadata)?);
        }
        Ok(Self { writer, channels })
    }

    /// Writes an encoded message of topic number `topic`.
    pub fn write(&mut self, topic: usize, time_ns: u64, message: &[u8]) -> McapResult<()> {
        let header = MessageHeader {
            channel_id: self.channels[topic],
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
