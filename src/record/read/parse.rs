//! Parsing of single MCAP records, safe for arbitrary bytes.

use mcap::records::{Record, op};
use mcap::{McapError, McapResult};

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
