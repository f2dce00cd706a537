//! Decoding of protobuf messages within bounded memory.

use foxglove::Decode;

/// The maximum memory that a decoded message may take for each of its bytes, and besides.
const MEMORY_PER_BYTE: usize = 16;
const MEMORY: usize = 1 << 20;
/// The memory of an entity or a primitive of a scene, and of a transform, even if it is empty. No
/// other part of a message takes more than a few times its bytes.
const PART: usize = 320;

/// Decodes a message.
///
/// # Errors
/// What is wrong with the message, as text.
pub fn decoded<M: Decode>(data: &[u8]) -> Result<M, String> {
    let parts = parts(data, 2).ok_or("it is not a protobuf message")?;
    if parts.saturating_mul(PART) > MEMORY_PER_BYTE * data.len() + MEMORY {
        let fault = format!(
            "its {parts} parts take far more memory than its {} bytes",
            data.len()
        );
        return Err(fault);
    }
    M::decode(data).map_err(|fault| fault.to_string())
}

/// Returns the number of fields with a length, down to this depth. Fields of this kind are messages
/// or texts; a text that is no message has no parts. Returns `None` if the message is cut off.
fn parts(mut data: &[u8], depth: u32) -> Option<usize> {
    let mut count = 0;
    while !data.is_empty() {
        let key = varint(&mut data)?;
        let length = match key & 7 {
            0 => {
                varint(&mut data)?;
                continue;
            }
            1 => 8,
            2 => usize::try_from(varint(&mut data)?).ok()?,
            5 => 4,
            _ => return None,
        };
        let (field, rest) = data.split_at_checked(length)?;
        data = rest;
        if key & 7 == 2 {
            count += 1;
            if depth > 1 {
                count += parts(field, depth - 1).unwrap_or(0);
            }
        }
    }
    Some(count)
}

/// Reads a number of seven bits per byte.
fn varint(data: &mut &[u8]) -> Option<u64> {
    let mut number = 0;
    for shift in (0..64).step_by(7) {
        let (&byte, rest) = data.split_first()?;
        *data = rest;
        number |= u64::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            return Some(number);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use foxglove::messages::{FrameTransforms, LinePrimitive, SceneEntity, SceneUpdate};

    use super::*;

    /// Returns a field with a length.
    fn field(number: u8, content: &[u8]) -> Vec<u8> {
        let mut bytes = vec![number << 3 | 2];
        let mut length = content.len();
        while length >= 0x80 {
            bytes.push(length as u8 | 0x80);
            length >>= 7;
        }
        bytes.push(length as u8);
        bytes.extend(content);
        bytes
    }

    #[test]
    fn messages_of_empty_parts_are_refused() {
        let many = 4 << 20;
        let entities = [0x12, 0].repeat(many);
        let transforms = [0x0a, 0].repeat(many);
        // Lines are the field 11 of an entity.
        let lines = field(2, &field(11, b"").repeat(many));
        let is_refused = |fault: String| fault.contains("far more memory");
        assert!(decoded::<SceneUpdate>(&entities).is_err_and(is_refused));
        assert!(decoded::<FrameTransforms>(&transforms).is_err_and(is_refused));
        assert!(decoded::<SceneUpdate>(&lines).is_err_and(is_refused));
        // Control: the fields are those of the messages.
        let few = decoded::<SceneUpdate>(&field(2, &field(11, b"").repeat(3))).unwrap();
        assert_eq!(few.entities[0].lines.len(), 3);
        assert_eq!(
            decoded::<SceneUpdate>(&entities[..6])
                .unwrap()
                .entities
                .len(),
            3
        );
        let few = decoded::<FrameTransforms>(&transforms[..6]).unwrap();
        assert_eq!(few.transforms.len(), 3);
    }

    #[test]
    fn no_part_takes_more_memory_than_is_assumed() {
        assert!(size_of::<SceneEntity>() <= PART);
        assert!(size_of::<LinePrimitive>() <= PART);
        assert!(size_of::<foxglove::messages::FrameTransform>() <= PART);
    }

    #[test]
    fn a_message_that_is_cut_off_is_refused() {
        for data in [&[0x12, 5, 0][..], &[0x80], &[0x12, 0xff, 0xff]] {
            assert!(decoded::<SceneUpdate>(data).is_err(), "{data:?}");
        }
    }
}
