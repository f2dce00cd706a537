//! Copies the complete records of a damaged MCAP file.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::Write;

use mcap::records::{self, AttachmentHeader, MessageHeader, Record};
use mcap::sans_io::linear_reader::LinearReaderOptions;
use mcap::{MAGIC, McapResult, Summary};

use crate::disk;
use crate::record::read::records::Records;
use crate::record::write::sink::{self, Packing, Sink};

/// The result of a recovery.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Recovery {
    /// The number of recovered messages.
    pub messages: u64,
    /// The number of recovered attachments.
    pub attachments: u64,
    /// The number of recovered metadata records.
    pub metadata: u64,
    /// The number of bytes of records that could not be recovered.
    pub lost_bytes: u64,
    /// The first fault that caused a loss.
    pub fault: Option<String>,
}

impl Recovery {
    /// Returns true if all written data was recovered.
    pub fn is_lossless(&self) -> bool {
        self.fault.is_none()
    }

    /// Counts a loss; the first one sets the fault.
    fn lose(&mut self, bytes: usize, at: usize, what: &dyn std::fmt::Display) {
        self.lost_bytes += bytes as u64;
        self.fault
            .get_or_insert_with(|| format!("from byte {at}: {what}"));
    }
}

/// Copies complete records into `sink`. The bytes begin with the magic of an MCAP file.
///
/// # Errors
/// The errors of the sink.
pub(super) fn copy_records<W: Write>(bytes: &[u8], sink: W) -> McapResult<(W, Recovery)> {
    let mut copier = RecordCopier::new(sink)?;
    // A valid index lists channels whose own records were lost.
    if let Some(summary) = valid_summary(bytes) {
        copier.add_channels(&summary)?;
    }
    let mut has_end = false;
    // Recovered data may be packed more tightly, and must be accepted when it is read back.
    let mut room = disk::most_unpacked(bytes.len() as u64) / 2;
    let options = LinearReaderOptions::default().with_emit_chunks(true);
    let mut records = Records::new(bytes, bytes.len() as u64, options);
    loop {
        let at = records.at();
        let Some(record) = records.next() else {
            break;
        };
        let size = records.at() - at;
        match record {
            // Only the index follows.
            Ok(Record::DataEnd(end)) => {
                has_end = true;
                copier.check_sum(&bytes[..at], end.data_section_crc);
                break;
            }
            Ok(Record::Chunk { header, .. }) => {
                let unpacked = header.uncompressed_size;
                if unpacked > room {
                    let what = format!(
                        "a chunk unpacks to {unpacked} bytes, more than is accepted for a file of this size"
                    );
                    copier.recovery.lose(size, at, &what);
                } else {
                    room -= unpacked;
                    copier.take_chunk(&bytes[at..at + size], at)?;
                }
            }
            Ok(record) => copier.take(record, at)?,
            // The file ends here, which is reported below.
            Err(_) if size == 0 => {}
            Err(fault) => copier.recovery.lose(size, at, &fault),
        }
    }
    let at = records.at();
    if !has_end && at < bytes.len() {
        let what = "the file ends within a record";
        copier.recovery.lose(bytes.len() - at, at, &what);
    }
    if !has_end {
        let what = "the end of the file is missing";
        copier.recovery.lose(0, bytes.len(), &what);
    }
    copier.finish()
}

/// Returns the index if its checksum is valid.
fn valid_summary(bytes: &[u8]) -> Option<Summary> {
    let footer = mcap::read::footer(bytes).ok()?;
    let start = usize::try_from(footer.summary_start).ok()?;
    // The checksum is the last field before the closing magic and covers all bytes before it.
    let end = bytes.len().checked_sub(MAGIC.len() + size_of::<u32>())?;
    let summed = bytes.get(start..end)?;
    let is_valid = start > 0 && crc32fast::hash(summed) == footer.summary_crc;
    is_valid
        .then(|| Summary::read(bytes).ok().flatten())
        .flatten()
}

/// Writes the recovered records.
struct RecordCopier<W: Write> {
    writer: Sink<W>,
    /// New numbers by old numbers.
    schemas: BTreeMap<u16, u16>,
    channels: BTreeMap<u16, u16>,
    recovery: Recovery,
}

impl<W: Write> RecordCopier<W> {
    fn new(sink: W) -> McapResult<Self> {
        Ok(Self {
            writer: sink::begin(sink, Packing::Small)?,
            schemas: BTreeMap::from([(0, 0)]),
            channels: BTreeMap::new(),
            recovery: Recovery::default(),
        })
    }

    fn add_channels(&mut self, summary: &Summary) -> McapResult<()> {
        let schemas: BTreeMap<_, _> = summary.schemas.iter().collect();
        for (&id, schema) in schemas {
            self.add_schema(id, &schema.name, &schema.encoding, &schema.data)?;
        }
        let channels: BTreeMap<_, _> = summary.channels.iter().collect();
        for (&id, channel) in channels {
            self.add_channel(&records::Channel {
                id,
                schema_id: channel.schema.as_ref().map_or(0, |schema| schema.id),
                topic: channel.topic.clone(),
                message_encoding: channel.message_encoding.clone(),
                metadata: channel.metadata.clone(),
            })?;
        }
        Ok(())
    }

    fn add_schema(&mut self, id: u16, name: &str, encoding: &str, data: &[u8]) -> McapResult<()> {
        let new = self.writer.add_schema(name, encoding, data)?;
        self.schemas.insert(id, new);
        Ok(())
    }

    fn add_channel(&mut self, channel: &records::Channel) -> McapResult<()> {
        if let Some(&schema) = self.schemas.get(&channel.schema_id) {
            let (topic, encoding) = (&channel.topic, &channel.message_encoding);
            let metadata = &channel.metadata;
            let new = self.writer.add_channel(schema, topic, encoding, metadata)?;
            self.channels.insert(channel.id, new);
        }
        Ok(())
    }

    /// Recovers a record of the data section.
    fn take(&mut self, record: Record<'_>, at: usize) -> McapResult<()> {
        match record {
            Record::Schema { header, data } => {
                self.add_schema(header.id, &header.name, &header.encoding, &data)?;
            }
            Record::Channel(channel) => self.add_channel(&channel)?,
            Record::Message { header, data } => self.take_message(header, &data, at)?,
            Record::Attachment { header, data, .. } => self.take_attachment(header, data)?,
            Record::Metadata(metadata) => {
                self.writer.write_metadata(&metadata)?;
                self.recovery.metadata += 1;
            }
            _ => {}
        }
        Ok(())
    }

    /// Recovers the records of a chunk; none if its checksum is wrong.
    fn take_chunk(&mut self, chunk: &[u8], at: usize) -> McapResult<()> {
        let options = LinearReaderOptions::default()
            .with_skip_start_magic(true)
            .with_skip_end_magic(true);
        for record in Records::new(chunk, chunk.len() as u64, options) {
            match record {
                Ok(record) => self.take(record, at)?,
                Err(fault) => {
                    self.recovery.lose(chunk.len(), at, &fault);
                    break;
                }
            }
        }
        Ok(())
    }

    fn take_message(&mut self, header: MessageHeader, data: &[u8], at: usize) -> McapResult<()> {
        let Some(&channel_id) = self.channels.get(&header.channel_id) else {
            let what = format!("channel {} is not defined", header.channel_id);
            self.recovery.lose(data.len(), at, &what);
            return Ok(());
        };
        let header = MessageHeader {
            channel_id,
            ..header
        };
        self.writer.write_to_known_channel(&header, data)?;
        self.recovery.messages += 1;
        Ok(())
    }

    fn take_attachment(&mut self, header: AttachmentHeader, data: Cow<'_, [u8]>) -> McapResult<()> {
        self.writer.attach(&mcap::Attachment {
            log_time: header.log_time,
            create_time: header.create_time,
            name: header.name,
            media_type: header.media_type,
            data,
        })?;
        self.recovery.attachments += 1;
        Ok(())
    }

    /// Verifies the checksum over all data, which detects changes that no record's own checksum
    /// covers.
    fn check_sum(&mut self, data: &[u8], expected: u32) {
        if expected != 0 && crc32fast::hash(data) != expected {
            let what = "the checksum of all data is wrong";
            self.recovery.lose(0, data.len(), &what);
        }
    }

    fn finish(self) -> McapResult<(W, Recovery)> {
        Ok((sink::finish(self.writer)?, self.recovery))
    }
}
