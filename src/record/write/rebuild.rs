//! Copies of an unfinished `run.mcap`, either to continue it with the same bytes, or to pack it
//! into fewer bytes when it is complete.

use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;

use mcap::records::{MessageHeader, Record};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{McapError, McapResult};

use super::log_file::OpenFile;
use crate::disk;
use crate::record::error::RecordError;
use crate::record::read::parse::parse_record;
use crate::record::read::reader::longest_record;
use crate::record::topics::Topic;

/// When the copy closes a chunk.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Chunks {
    /// At the same positions as the source.
    AsBefore,
    /// When a chunk is full.
    Full,
}

/// Copies the first `messages` messages of `source` to `file` and verifies the checksums.
pub fn copy(
    source: &Path,
    messages: u64,
    chunks: Chunks,
    file: &mut OpenFile,
) -> Result<(), RecordError> {
    let unreadable = |cause| RecordError::Read {
        path: source.to_owned(),
        cause,
    };
    let damaged = |cause: McapError| RecordError::Damaged {
        path: source.to_owned(),
        cause: cause.to_string(),
    };
    let mut input = disk::open(source).map_err(unreadable)?;
    let bytes = input.metadata().map_err(unreadable)?.len();
    let options = LinearReaderOptions::default()
        .with_prevalidate_chunk_crcs(true)
        .with_record_length_limit(longest_record(bytes));
    let mut reader = LinearReader::new_with_options(options);
    let mut copy = Copy {
        file,
        chunks,
        topics: BTreeMap::new(),
        left: messages,
    };
    let (mut unpacked, most) = (0, disk::most_unpacked(bytes));
    while copy.left > 0 {
        match reader.next_event().transpose().map_err(damaged)? {
            Some(LinearReadEvent::ReadRequest(wanted)) => {
                let read = input.read(reader.insert(wanted)).map_err(unreadable)?;
                reader.notify_read(read);
            }
            Some(LinearReadEvent::Record { opcode, data }) => {
                unpacked += data.len() as u64;
                if unpacked > most {
                    return Err(damaged(McapError::ChunkTooLarge(unpacked)));
                }
                copy.take(parse_record(opcode, data).map_err(damaged)?)?;
            }
            None => return Err(damaged(McapError::UnexpectedEof)),
        }
    }
    copy.file.with(|log| log.flush())
}

/// The state of a copy; `left` is the number of remaining messages.
struct Copy<'a> {
    file: &'a mut OpenFile,
    chunks: Chunks,
    topics: BTreeMap<u16, Topic>,
    left: u64,
}

impl Copy<'_> {
    fn take(&mut self, record: Record<'_>) -> Result<(), RecordError> {
        match record {
            Record::Channel(channel) => {
                if let Some(topic) = Topic::named(&channel.topic) {
                    self.topics.insert(channel.id, topic);
                }
                Ok(())
            }
            Record::Message { header, data } => {
                self.left -= 1;
                self.file
                    .with(|log| send(log, &self.topics, &header, &data))
            }
            // Message indexes follow a chunk.
            Record::MessageIndex(_) if self.chunks == Chunks::AsBefore => {
                self.file.with(|log| log.flush())
            }
            _ => Ok(()),
        }
    }
}

fn send<W: std::io::Write>(
    log: &mut super::log_file::LogFile<W>,
    topics: &BTreeMap<u16, Topic>,
    header: &MessageHeader,
    data: &[u8],
) -> McapResult<()> {
    match topics.get(&header.channel_id) {
        Some(&topic) => log.message(topic, header.log_time, data),
        None => Err(McapError::UnknownChannel(
            header.sequence,
            header.channel_id,
        )),
    }
}
