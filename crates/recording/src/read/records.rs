//! The records of MCAP files, safe for arbitrary bytes.

use std::io::Read;

use mcap::read::ChannelAccumulator;
use mcap::records::{Record, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{McapError, McapResult, Message};

use crate::disk;

/// The number of bytes by which the kept records of a file may exceed its size.
const MOST_KEPT_BYTES: u64 = 4 << 20;

/// The records of an MCAP stream in sequence, with those inside of chunks, unless the options say
/// otherwise. Checksums of chunks are verified. A fault of the stream is the last item. A record
/// that cannot be parsed is an error, too, but the records after it follow.
///
/// Schemas, channels, metadata and attachments are kept in memory. A packed chunk can hold very many of them, so all
/// together may be only a little longer than the file.
pub struct Records<R> {
    stream: R,
    /// The number of bytes of further schemas, channels, metadata and attachments that are accepted.
    room: u64,
    /// `None` after the end and after a fault of the stream.
    reader: Option<LinearReader>,
}

impl<R: Read> Records<R> {
    /// Reads a stream of `size` bytes.
    pub fn new(stream: R, size: u64, options: LinearReaderOptions) -> Self {
        let options = options
            .with_prevalidate_chunk_crcs(true)
            .with_record_length_limit(longest_record(size));
        Self {
            stream,
            room: size.saturating_add(MOST_KEPT_BYTES),
            reader: Some(LinearReader::new_with_options(options)),
        }
    }
}

impl<R: Read> Iterator for Records<R> {
    type Item = McapResult<Record<'static>>;

    fn next(&mut self) -> Option<Self::Item> {
        let reader = self.reader.as_mut()?;
        let fault = loop {
            match reader.next_event()? {
                Ok(LinearReadEvent::ReadRequest(wanted)) => {
                    match self.stream.read(reader.insert(wanted)) {
                        Ok(bytes) => reader.notify_read(bytes),
                        Err(cause) => break McapError::Io(cause),
                    }
                }
                Ok(LinearReadEvent::Record { opcode, data }) => {
                    let len = data.len() as u64;
                    match self.room.checked_sub(kept_bytes(opcode, len)) {
                        Some(room) => self.room = room,
                        None => break McapError::RecordTooLarge { opcode, len },
                    }
                    return Some(parse_record(opcode, data).map(Record::into_owned));
                }
                Err(fault) => break fault,
            }
        };
        self.reader = None;
        Some(Err(fault))
    }
}

/// Returns the messages of an MCAP file in sequence, each with its channel.
pub fn messages(bytes: &[u8]) -> impl Iterator<Item = McapResult<Message<'static>>> {
    let mut channels = ChannelAccumulator::default();
    let options = LinearReaderOptions::default();
    let records = Records::new(bytes, bytes.len() as u64, options);
    records.filter_map(move |record| match record {
        Ok(Record::Schema { header, data }) => channels.add_schema(header, data).err().map(Err),
        Ok(Record::Channel(channel)) => channels.add_channel(channel).err().map(Err),
        Ok(Record::Message { header, data }) => {
            let unknown = McapError::UnknownChannel(header.sequence, header.channel_id);
            let channel = channels.get(header.channel_id).ok_or(unknown);
            Some(channel.map(|channel| Message {
                channel,
                sequence: header.sequence,
                log_time: header.log_time,
                publish_time: header.publish_time,
                data,
            }))
        }
        Ok(_) => None,
        Err(fault) => Some(Err(fault)),
    })
}

/// Rejects a file that unpacks to far more bytes than its size, before unpacking any of it.
///
/// # Errors
/// What is wrong with the file, as text.
pub fn check_unpacked(bytes: &[u8]) -> Result<(), String> {
    let most = disk::most_unpacked(bytes.len() as u64);
    let options = LinearReaderOptions::default().with_emit_chunks(true);
    let mut unpacked: u64 = 0;
    let mut records = Records::new(bytes, bytes.len() as u64, options);
    while let Some(record) = records.next() {
        match record {
            Ok(Record::Chunk { header, .. }) => {
                unpacked = unpacked.saturating_add(header.uncompressed_size);
            }
            // After it, nothing more can be counted, but the next reader might unpack it.
            Err(fault) if records.reader.is_none() => return Err(fault.to_string()),
            _ => {}
        }
    }
    if unpacked <= most {
        Ok(())
    } else {
        Err(format!(
            "its chunks unpack to {unpacked} bytes, but at most {most} are accepted for a file of its size"
        ))
    }
}

/// Returns how much of a record is kept in memory.
fn kept_bytes(opcode: u8, len: u64) -> u64 {
    match opcode {
        op::SCHEMA | op::CHANNEL | op::METADATA | op::ATTACHMENT => len,
        _ => 0,
    }
}

/// Returns the maximum accepted length of a record in a file of this many bytes: damaged lengths in
/// a small file must not fill the memory. A record is copied up to four times.
fn longest_record(bytes: u64) -> usize {
    usize::try_from(disk::room_for(bytes) / 4).unwrap_or(usize::MAX)
}

/// Parses a record. The library assumes that an attachment is as long as its length fields say, and
/// panics otherwise. This function returns an error instead.
fn parse_record(opcode: u8, body: &[u8]) -> McapResult<Record<'_>> {
    if opcode == op::ATTACHMENT && attachment_header(body).is_none() {
        return Err(McapError::BadAttachmentLength {
            header: 0,
            available: body.len() as u64,
        });
    }
    mcap::parse_record(opcode, body)
}

/// Returns the number of bytes before an attachment's content: two times, two texts and a length.
/// Returns `None` if there is no room left for the checksum after the content.
fn attachment_header(body: &[u8]) -> Option<usize> {
    let after_text = |at: usize| {
        let length = body.get(at..at.checked_add(4)?)?.try_into().ok()?;
        (at + 4).checked_add(u32::from_le_bytes(length) as usize)
    };
    let header = after_text(after_text(16)?)?.checked_add(8)?;
    (header.checked_add(4)? <= body.len()).then_some(header)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_attachment_that_is_shorter_than_its_header_says_is_an_error() {
        // Two times, an empty name, an empty media type, a length, and three of the four bytes of
        // the checksum.
        let body = [0; 16 + 4 + 4 + 8 + 3];
        for length in 0..body.len() {
            let parsed = parse_record(op::ATTACHMENT, &body[..length]);
            assert!(parsed.is_err(), "{length} bytes");
        }
    }
}
