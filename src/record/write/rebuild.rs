//! Copies of an unfinished `run.mcap`, to continue it with the same bytes.

use std::collections::BTreeMap;
use std::path::Path;

use mcap::McapError;
use mcap::records::Record;
use mcap::sans_io::linear_reader::LinearReaderOptions;

use super::log_file::OpenFile;
use crate::disk;
use crate::error::Error;
use crate::record::error;
use crate::record::read::records::Records;
use crate::record::topics::Topic;

/// Copies the first `messages` messages of `source` to `file` and verifies the checksums.
pub fn copy(source: &Path, messages: u64, file: &mut OpenFile) -> Result<(), Error> {
    let unreadable = disk::cannot_read(source);
    let fault = |cause| match cause {
        McapError::Io(cause) => unreadable(cause),
        cause => error::damaged(source)(cause),
    };
    let input = disk::open(source).map_err(&unreadable)?;
    let size = input.metadata().map_err(&unreadable)?.len();
    let mut topics: BTreeMap<u16, Topic> = BTreeMap::new();
    let (mut left, mut room) = (messages, disk::most_unpacked(size));
    let options = LinearReaderOptions::default();
    for record in Records::new(input, size, options) {
        match record.map_err(fault)? {
            Record::Channel(channel) => {
                let topic = Topic::named(&channel.topic);
                topics.extend(topic.map(|topic| (channel.id, topic)));
            }
            Record::Message { header, data } => {
                let bytes = data.len() as u64;
                room = room
                    .checked_sub(bytes)
                    .ok_or_else(|| fault(McapError::ChunkTooLarge(bytes)))?;
                let unknown = McapError::UnknownChannel(header.sequence, header.channel_id);
                let topic = topics.get(&header.channel_id);
                let topic = topic.ok_or_else(|| fault(unknown))?;
                file.with(|log| log.message(*topic, header.log_time, &data))?;
                left = left.saturating_sub(1);
            }
            // Message indexes follow a chunk.
            Record::MessageIndex(_) => {
                file.with(|log| log.flush())?;
            }
            _ => {}
        }
        if left == 0 {
            break;
        }
    }
    match left {
        0 => file.with(|log| log.flush()),
        _ => Err(fault(McapError::UnexpectedEof)),
    }
}
