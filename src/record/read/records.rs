//! The records of MCAP files, safe for arbitrary bytes.

use std::io::Read;
use std::ops::ControlFlow;

use mcap::records::{Record, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{MAGIC, McapError, McapResult};

use crate::disk;

/// The number of bytes of the opcode and the length before each record.
pub(in crate::record) const HEAD_BYTES: usize = 9;

/// Passes the records of a stream of `size` bytes to `take`, with those inside of chunks, until
/// `take` breaks. Checksums are verified as the options say.
///
/// # Errors
/// Errors of `take`, and those of the stream as `fault` converts them.
pub(in crate::record) fn for_each_record<E>(
    mut stream: impl Read,
    size: u64,
    options: LinearReaderOptions,
    fault: impl Fn(McapError) -> E,
    mut take: impl FnMut(Record<'_>) -> Result<ControlFlow<()>, E>,
) -> Result<(), E> {
    let options = options
        .with_prevalidate_chunk_crcs(true)
        .with_record_length_limit(longest_record(size));
    let mut reader = LinearReader::new_with_options(options);
    while let Some(event) = reader.next_event() {
        match event.map_err(&fault)? {
            LinearReadEvent::ReadRequest(wanted) => {
                let read = stream.read(reader.insert(wanted));
                reader.notify_read(read.map_err(|cause| fault(McapError::Io(cause)))?);
            }
            LinearReadEvent::Record { opcode, data } => {
                let record = parse_record(opcode, data).map_err(&fault)?;
                if take(record)?.is_break() {
                    return Ok(());
                }
            }
        }
    }
    Ok(())
}

/// Returns the maximum accepted length of a record in a file of this many bytes: damaged lengths in
/// a small file must not fill the memory. A record is copied up to four times.
fn longest_record(bytes: u64) -> usize {
    usize::try_from(disk::room_for(bytes) / 4).unwrap_or(usize::MAX)
}

/// Parses a record. The library assumes that an attachment is as long as its length fields say, and
/// panics otherwise. This function returns an error instead.
pub fn parse_record(opcode: u8, body: &[u8]) -> McapResult<Record<'_>> {
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

/// Returns the unpacked size stated by a chunk; `None` for other records. No more than this is ever
/// unpacked.
pub(in crate::record) fn unpacked_size(opcode: u8, body: &[u8]) -> Option<u64> {
    // The size follows the times of the first and the last message.
    let size = body.get(16..24).filter(|_| opcode == op::CHUNK)?;
    Some(u64::from_le_bytes(size.try_into().ok()?))
}

/// The complete records of a file in sequence: position, opcode and body.
pub(in crate::record) struct Records<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Records<'a> {
    /// Iterates over a file that begins with the magic.
    pub fn of(bytes: &'a [u8]) -> Self {
        let at = MAGIC.len();
        Self { bytes, at }
    }

    /// Returns the position of the next record.
    pub fn at(&self) -> usize {
        self.at
    }
}

impl<'a> Iterator for Records<'a> {
    type Item = (usize, u8, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        let at = self.at;
        let head = self.bytes.get(at..at + HEAD_BYTES)?;
        let (opcode, length) = head.split_first()?;
        let length = u64::from_le_bytes(length.try_into().ok()?);
        let start = at + HEAD_BYTES;
        let end = start.checked_add(usize::try_from(length).ok()?)?;
        let body = self.bytes.get(start..end)?;
        self.at = end;
        Some((at, *opcode, body))
    }
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
