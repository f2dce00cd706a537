//! How MCAP puts numbers, texts and maps into bytes.

use std::collections::BTreeMap;

/// Kinds of records, by their number in the format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Kind {
    /// Who wrote the file, and by which profile.
    Header = 1,
    /// Where the summary begins, and its checksum.
    Footer,
    /// What messages of a kind consist of.
    Schema,
    /// A topic, its schema and its encoding.
    Channel,
    /// A message of a channel, with its times.
    Message,
    /// Records packed together.
    Chunk,
    /// Where in a chunk the messages of a channel are.
    MessageIndex,
    /// Where a chunk is, and from when to when it goes.
    ChunkIndex,
    /// A file within the file.
    Attachment,
    /// Where an attachment is.
    AttachmentIndex,
    /// How many records of which kinds there are.
    Statistics,
    /// Texts by name.
    Metadata,
    /// Where metadata are.
    MetadataIndex,
    /// The end of the data, before the summary.
    DataEnd = 15,
}

/// The bytes of a record while it is put together.
#[derive(Debug, Default)]
pub struct Bytes(pub Vec<u8>);

impl Bytes {
    pub fn u16(mut self, number: u16) -> Self {
        self.0.extend(number.to_le_bytes());
        self
    }

    pub fn u32(mut self, number: u32) -> Self {
        self.0.extend(number.to_le_bytes());
        self
    }

    pub fn u64(mut self, number: u64) -> Self {
        self.0.extend(number.to_le_bytes());
        self
    }

    /// Numbers one after the other.
    pub fn u64s<const N: usize>(self, numbers: [u64; N]) -> Self {
        numbers.into_iter().fold(self, Self::u64)
    }

    /// Bytes as they are.
    pub fn raw(mut self, bytes: &[u8]) -> Self {
        self.0.extend_from_slice(bytes);
        self
    }

    /// A text after its length.
    pub fn text(self, text: &str) -> Self {
        self.u32(text.len() as u32).raw(text.as_bytes())
    }

    /// A map or list after its length in bytes.
    pub fn list(self, add: impl FnOnce(Self) -> Self) -> Self {
        let list = add(Self::default()).0;
        self.u32(list.len() as u32).raw(&list)
    }

    /// A map of texts.
    pub fn texts(self, map: &BTreeMap<String, String>) -> Self {
        self.list(|list| {
            map.iter()
                .fold(list, |list, (key, value)| list.text(key).text(value))
        })
    }

    /// A map of numbers by channel.
    pub fn by_channel(self, map: &BTreeMap<u16, u64>) -> Self {
        self.list(|list| {
            map.iter().fold(list, |list, (&channel, &number)| {
                list.u16(channel).u64(number)
            })
        })
    }
}
