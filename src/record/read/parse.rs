//! One MCAP record, or one JSON text in it, whatever its bytes.

use mcap::records::{Record, op};
use mcap::{McapError, McapResult};

/// Parses a record. The library takes for granted that an attachment is as long as its own
/// lengths say, and panics on one that is not; here that is an error.
pub fn parse_record(opcode: u8, body: &[u8]) -> McapResult<Record<'_>> {
    if opcode == op::ATTACHMENT && attachment_header(body).is_none() {
        return Err(McapError::BadAttachmentLength {
            header: 0,
            available: body.len() as u64,
        });
    }
    mcap::parse_record(opcode, body)
}

/// The bytes before an attachment's content: two times, two texts and a length. `None` if they
/// leave no room for the checksum behind it.
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
        // Two times, an empty name, an empty media type, a length, and three of four bytes of
        // checksum.
        let body = [0; 16 + 4 + 4 + 8 + 3];
        for length in 0..body.len() {
            let parsed = parse_record(op::ATTACHMENT, &body[..length]);
            assert!(parsed.is_err(), "{length} bytes");
        }
    }
}
