//! A stream of MCAP records, with its chunks and its index.
//!
//! The writer of the crate `mcap` packs a chunk before it knows how long that will be, with tables
//! for any length, which it makes and clears anew for each file: for an episode of 80 kB that took
//! longer than packing it. This one packs whole chunks. It does not keep the tables either: with
//! used ones zstd would pack the same episode to other bytes.

use std::collections::BTreeMap;
use std::io::{self, Write};

use mcap::records::{MessageHeader, Metadata};
use mcap::{Attachment, MAGIC, McapError, McapResult};

use super::encoding::{Bytes, Kind};

/// Uncompressed size at which a chunk is closed, in bytes.
const CHUNK_BYTES: usize = 512 * 1024;
/// What the header says about who wrote the file.
const LIBRARY: &str = concat!("xcscr/", env!("CARGO_PKG_VERSION"));
/// How chunks are packed, as the format names it.
const ZSTD: &str = "zstd";

/// How much work is put into small files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Packing {
    /// Little: the file is written again when it is whole.
    Quick,
    /// As much as pays.
    Small,
}

impl Packing {
    fn level(self) -> i32 {
        match self {
            Self::Quick => 1,
            Self::Small => 8,
        }
    }
}

/// Where records go. The same calls give the same bytes. After an error it is of no more use.
pub struct Sink<W> {
    out: Counted<W>,
    packing: Packing,
    chunk: Chunk,
    schemas: Numbered,
    channels: Numbered,
    /// Of the attachments, chunks and metadata, as the summary has them.
    indexes: Vec<(Kind, Bytes)>,
    span: Option<(u64, u64)>,
    counts: BTreeMap<u16, u64>,
}

/// Contents of records, each with the number that it was given.
type Numbered = BTreeMap<Vec<u8>, u16>;

/// Records that will be packed together.
#[derive(Default)]
struct Chunk {
    records: Vec<u8>,
    /// When the first and the last message were logged.
    span: Option<(u64, u64)>,
    /// By channel: time and place of each message.
    places: BTreeMap<u16, Vec<(u64, u64)>>,
}

/// Knows how much was written, and its checksum.
struct Counted<W> {
    sink: W,
    at: u64,
    sum: crc32fast::Hasher,
}

impl<W: Write> Counted<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.sink.write_all(bytes)?;
        self.at += bytes.len() as u64;
        self.sum.update(bytes);
        Ok(())
    }

    fn record(&mut self, kind: Kind, body: &[u8]) -> io::Result<()> {
        self.write(&head(kind, body.len()))?;
        self.write(body)
    }
}

/// What comes before the body of a record.
fn head(kind: Kind, length: usize) -> [u8; 9] {
    let mut head = [kind as u8; 9];
    head[1..].copy_from_slice(&(length as u64).to_le_bytes());
    head
}

fn widened(span: Option<(u64, u64)>, time: u64) -> Option<(u64, u64)> {
    let (first, last) = span.unwrap_or((time, time));
    Some((first.min(time), last.max(time)))
}

impl Chunk {
    fn record(&mut self, kind: Kind, [start, rest]: [&[u8]; 2]) {
        let length = start.len() + rest.len();
        self.records.extend_from_slice(&head(kind, length));
        self.records.extend_from_slice(start);
        self.records.extend_from_slice(rest);
    }

    fn message(&mut self, header: &MessageHeader, data: &[u8]) {
        self.span = widened(self.span, header.log_time);
        let place = (header.log_time, self.records.len() as u64);
        self.places
            .entry(header.channel_id)
            .or_default()
            .push(place);
        let start = Bytes::default().u16(header.channel_id).u32(header.sequence);
        let start = start.u64s([header.log_time, header.publish_time]);
        self.record(Kind::Message, [&start.0, data]);
    }
}

impl<W: Write> Sink<W> {
    /// Begins an MCAP stream.
    pub fn new(sink: W, packing: Packing) -> McapResult<Self> {
        let sum = crc32fast::Hasher::new();
        let mut out = Counted { sink, at: 0, sum };
        out.write(MAGIC)?;
        out.record(Kind::Header, &Bytes::default().text("").text(LIBRARY).0)?;
        Ok(Self {
            out,
            packing,
            chunk: Chunk::default(),
            schemas: Numbered::new(),
            channels: Numbered::new(),
            indexes: Vec::new(),
            span: None,
            counts: BTreeMap::new(),
        })
    }

    /// The number of a schema, which is declared now if it never was.
    pub fn add_schema(&mut self, name: &str, encoding: &str, data: &[u8]) -> McapResult<u16> {
        let content = Bytes::default().text(name).text(encoding);
        let content = content.list(|list| list.raw(data)).0;
        let full = McapError::TooManySchemas;
        number(&mut self.schemas, content, Kind::Schema, &mut self.chunk).ok_or(full)
    }

    /// The number of a channel, which is declared now if it never was; schema 0 is none.
    pub fn add_channel(
        &mut self,
        schema: u16,
        topic: &str,
        encoding: &str,
        metadata: &BTreeMap<String, String>,
    ) -> McapResult<u16> {
        let content = Bytes::default().u16(schema).text(topic).text(encoding);
        let content = content.texts(metadata).0;
        let full = McapError::TooManyChannels;
        number(&mut self.channels, content, Kind::Channel, &mut self.chunk).ok_or(full)
    }

    /// Writes a message on a channel that was declared.
    pub fn message(&mut self, header: &MessageHeader, data: &[u8]) -> McapResult<()> {
        let channel = header.channel_id;
        if channel == 0 || usize::from(channel) > self.channels.len() {
            return Err(McapError::UnknownChannel(header.sequence, channel));
        }
        if self.chunk.records.len() > CHUNK_BYTES {
            self.close_chunk()?;
        }
        self.span = widened(self.span, header.log_time);
        *self.counts.entry(channel).or_default() += 1;
        self.chunk.message(header, data);
        Ok(())
    }

    /// Attaches a file.
    pub fn attach(&mut self, file: &Attachment<'_>) -> McapResult<()> {
        self.close_chunk()?;
        let (times, size) = ([file.log_time, file.create_time], file.data.len() as u64);
        let body = Bytes::default().u64s(times).text(&file.name);
        let body = body.text(&file.media_type).u64(size).raw(&file.data);
        let sum = crc32fast::hash(&body.0);
        let (at, length) = self.placed(Kind::Attachment, &body.u32(sum))?;
        let index = Bytes::default().u64s([at, length]).u64s(times).u64(size);
        let index = index.text(&file.name).text(&file.media_type);
        self.indexes.push((Kind::AttachmentIndex, index));
        Ok(())
    }

    /// Writes a metadata record.
    pub fn metadata(&mut self, metadata: &Metadata) -> McapResult<()> {
        self.close_chunk()?;
        let body = Bytes::default().text(&metadata.name);
        let (at, length) = self.placed(Kind::Metadata, &body.texts(&metadata.metadata))?;
        let index = Bytes::default().u64s([at, length]).text(&metadata.name);
        self.indexes.push((Kind::MetadataIndex, index));
        Ok(())
    }

    /// Closes the chunk and hands everything on.
    pub fn flush(&mut self) -> McapResult<()> {
        self.close_chunk()?;
        Ok(self.out.sink.flush()?)
    }

    /// Writes the summary and gives the sink back.
    pub fn finish(mut self) -> McapResult<W> {
        self.close_chunk()?;
        let sum = self.out.sum.clone().finalize();
        let body = Bytes::default().u32(sum);
        self.out.record(Kind::DataEnd, &body.0)?;
        let start = self.out.at;
        self.out.sum = crc32fast::Hasher::new();
        self.summarise()?;
        let footer = Bytes::default().raw(&head(Kind::Footer, 20));
        self.out.write(&footer.u64s([start, 0]).0)?;
        let sum = self.out.sum.clone().finalize();
        self.out.write(&sum.to_le_bytes())?;
        self.out.write(MAGIC)?;
        Ok(self.out.sink)
    }

    /// Writes a record. Gives its place, and its length with the head.
    fn placed(&mut self, kind: Kind, body: &Bytes) -> io::Result<(u64, u64)> {
        let at = self.out.at;
        self.out.record(kind, &body.0)?;
        Ok((at, self.out.at - at))
    }

    fn close_chunk(&mut self) -> io::Result<()> {
        if self.chunk.records.is_empty() {
            return Ok(());
        }
        let Chunk {
            records,
            span,
            places,
        } = std::mem::take(&mut self.chunk);
        let packed = zstd::bulk::compress(&records, self.packing.level())?;
        let ((first, last), unpacked) = (span.unwrap_or_default(), records.len() as u64);
        let body = Bytes::default().u64s([first, last, unpacked]);
        let body = body.u32(crc32fast::hash(&records)).text(ZSTD);
        let body = body.u64(packed.len() as u64).raw(&packed);
        let (at, length) = self.placed(Kind::Chunk, &body)?;
        let indexes_at = self.out.at;
        let indexes = self.index_messages(&places)?;
        let index = Bytes::default().u64s([first, last, at, length]);
        let index = index.by_channel(&indexes).u64(self.out.at - indexes_at);
        let index = index.text(ZSTD).u64s([packed.len() as u64, unpacked]);
        self.indexes.push((Kind::ChunkIndex, index));
        Ok(())
    }

    /// Writes where the messages of a chunk are. Gives the place of this by channel.
    fn index_messages(
        &mut self,
        places: &BTreeMap<u16, Vec<(u64, u64)>>,
    ) -> io::Result<BTreeMap<u16, u64>> {
        let mut indexes = BTreeMap::new();
        for (&channel, places) in places {
            let add = |list: Bytes, &(time, at): &(u64, u64)| list.u64s([time, at]);
            let body = Bytes::default().u16(channel);
            let body = body.list(|list| places.iter().fold(list, add));
            let (at, _) = self.placed(Kind::MessageIndex, &body)?;
            indexes.insert(channel, at);
        }
        Ok(indexes)
    }

    /// Writes all that a reader wants to know without reading the data.
    fn summarise(&mut self) -> io::Result<()> {
        for (numbered, kind) in [
            (&self.schemas, Kind::Schema),
            (&self.channels, Kind::Channel),
        ] {
            let mut contents: Vec<_> = numbered.iter().collect();
            contents.sort_unstable_by_key(|&(_, number)| number);
            for (content, &number) in contents {
                let body = Bytes::default().u16(number).raw(content);
                self.out.record(kind, &body.0)?;
            }
        }
        let statistics = self.statistics();
        self.out.record(Kind::Statistics, &statistics.0)?;
        for kind in [Kind::ChunkIndex, Kind::AttachmentIndex, Kind::MetadataIndex] {
            let mut of_kind = self.indexes.iter().filter(|(other, _)| *other == kind);
            of_kind.try_for_each(|(kind, index)| self.out.record(*kind, &index.0))?;
        }
        Ok(())
    }

    fn statistics(&self) -> Bytes {
        let (first, last) = self.span.unwrap_or_default();
        let count = |kind| {
            self.indexes
                .iter()
                .filter(|(other, _)| *other == kind)
                .count() as u32
        };
        Bytes::default()
            .u64(self.counts.values().sum())
            .u16(self.schemas.len() as u16)
            .u32(self.channels.len() as u32)
            .u32(count(Kind::AttachmentIndex))
            .u32(count(Kind::MetadataIndex))
            .u32(count(Kind::ChunkIndex))
            .u64s([first, last])
            .by_channel(&self.counts)
    }
}

/// The number of a content, which is declared in the chunk if it is new; `None` if there are none
/// left.
fn number(known: &mut Numbered, content: Vec<u8>, kind: Kind, chunk: &mut Chunk) -> Option<u16> {
    if let Some(&number) = known.get(&content) {
        return Some(number);
    }
    let number = u16::try_from(known.len() + 1).ok()?;
    chunk.record(kind, [&number.to_le_bytes(), &content]);
    known.insert(content, number);
    Some(number)
}
