//! Reading recordings back.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use mcap::read::ChannelAccumulator;
use mcap::records::{Record, op};
use mcap::sans_io::linear_reader::LinearReaderOptions;
use mcap::{Channel, MAGIC, McapError, McapResult};
use serde::Serialize;

use super::records::{self, Records};
use crate::EPOCH_NS;
use crate::disk;
use crate::error::{Error, ErrorKind};
use crate::fault;
use crate::info::{KIND, RecordingKind, RunKind};
use crate::resume_hint::way_to_resume;

/// A recording in memory with valid checksums.
#[derive(Debug, Clone)]
pub struct Recording {
    path: PathBuf,
    bytes: Vec<u8>,
    attachments: Vec<Attachment>,
    metadata: BTreeMap<String, BTreeMap<String, String>>,
    channels: BTreeMap<u16, Arc<Channel<'static>>>,
    /// The number of messages read by channel.
    counts: BTreeMap<u16, u64>,
    /// The number of messages by channel, according to the file's own index.
    claimed: BTreeMap<u16, u64>,
    /// True if the file's own index lists chunks.
    has_chunk_index: bool,
}

/// The longest accepted name of a schema. Each topic of the file repeats it.
const MAX_SCHEMA_NAME: usize = 1_024;

/// The longest JSON text that is parsed into a tree. The tree takes up to thirty times as much
/// memory. Our messages are far shorter.
const MAX_TREE_BYTES: usize = 1 << 20;

/// A topic and its contents.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct TopicInfo {
    /// The topic's name.
    pub name: String,
    /// The schema's name; empty without a schema.
    pub schema: String,
    /// The schema's text or descriptor; omitted where topics are listed.
    #[serde(skip)]
    pub schema_data: Arc<[u8]>,
    /// `json` or `protobuf`.
    pub encoding: String,
    /// The number of messages.
    pub messages: u64,
}

/// A message of a recording.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    channel: Arc<mcap::Channel<'static>>,
    /// The log time, in nanoseconds since the beginning of the run.
    pub time_ns: u64,
    /// The encoded message.
    pub data: Vec<u8>,
}

impl Message {
    /// Returns the topic of the message.
    pub fn topic(&self) -> &str {
        &self.channel.topic
    }

    /// Returns the encoding: `json` or `protobuf`.
    pub fn encoding(&self) -> &str {
        &self.channel.message_encoding
    }

    /// Parses the message as JSON. Returns `None` for other encodings, and for texts larger than
    /// any message of ours.
    pub fn json(&self) -> Option<serde_json::Value> {
        let is_small = self.encoding() == "json" && self.data.len() <= MAX_TREE_BYTES;
        is_small.then(|| serde_json::from_slice(&self.data).ok())?
    }
}

/// A text attached to a recording.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attachment {
    /// The attachment's file name.
    pub name: String,
    /// The media type.
    pub media_type: String,
    /// The content.
    pub data: Vec<u8>,
}

impl Recording {
    /// Reads a file and verifies its checksums.
    ///
    /// # Errors
    /// If the file cannot be read; otherwise as for [`Self::from_bytes`].
    pub fn open(path: &Path) -> Result<Self, Error> {
        let bytes = disk::read(path, disk::MOST_BYTES).map_err(fault::cannot_read(path))?;
        let folder = path.parent().filter(|_| is_unfinished(path));
        match folder.and_then(way_to_resume) {
            Some(hint) => {
                let message = format!(
                    "this run was interrupted, and no viewer can open its unfinished recording; {hint}"
                );
                Err(ErrorKind::BadData.error(message))
            }
            None => Self::from_bytes(path, bytes),
        }
    }

    /// Reads a recording from memory. Error messages refer to the recording as `path`.
    ///
    /// # Errors
    /// If the name ends with `.part`, the bytes are not an MCAP file, the file is incomplete, or a
    /// checksum is wrong.
    pub fn from_bytes(path: &Path, bytes: Vec<u8>) -> Result<Self, Error> {
        if is_unfinished(path) {
            let message = format!(
                "this recording was never finished, so viewers cannot open it; `mcap recover` saves \
                 the readable part: {}",
                path.display()
            );
            return Err(ErrorKind::BadData.error(message));
        }
        if !bytes.starts_with(MAGIC) {
            return Err(fault::not_a_recording(path, &bytes));
        }
        let damaged = fault::damaged(path);
        records::check_unpacked(&bytes).map_err(fault::damaged(path))?;
        let mut recording = Self {
            path: path.to_owned(),
            attachments: Vec::new(),
            metadata: BTreeMap::new(),
            channels: BTreeMap::new(),
            counts: BTreeMap::new(),
            claimed: BTreeMap::new(),
            has_chunk_index: false,
            bytes: Vec::new(),
        };
        recording.scan(&bytes).map_err(&damaged)?;
        recording.bytes = bytes;
        Ok(recording)
    }

    /// Reads every record, verifies all checksums, and stores everything but the messages.
    fn scan(&mut self, bytes: &[u8]) -> McapResult<()> {
        let options = LinearReaderOptions::default()
            .with_check_finishes_after_end_magic(true)
            .with_validate_data_section_crc(true)
            .with_validate_summary_section_crc(true);
        let mut known = ChannelAccumulator::default();
        for record in Records::new(bytes, bytes.len() as u64, options) {
            self.keep(record?, &mut known)?;
        }
        Ok(())
    }

    fn keep(
        &mut self,
        record: Record<'static>,
        known: &mut ChannelAccumulator<'static>,
    ) -> McapResult<()> {
        match record {
            Record::Attachment { header, data, .. } => self.attachments.push(Attachment {
                name: header.name,
                media_type: header.media_type,
                data: data.into_owned(),
            }),
            Record::Metadata(record) => {
                self.metadata.insert(record.name, record.metadata);
            }
            Record::Schema { header, .. } if header.name.len() > MAX_SCHEMA_NAME => {
                return Err(McapError::RecordTooLarge {
                    opcode: op::SCHEMA,
                    len: header.name.len() as u64,
                });
            }
            Record::Schema { header, data } => known.add_schema(header, data)?,
            Record::Channel(channel) => {
                let id = channel.id;
                known.add_channel(channel)?;
                self.channels
                    .extend(known.get(id).map(|channel| (id, channel)));
            }
            Record::Statistics(counted) => self.claimed = counted.channel_message_counts,
            Record::ChunkIndex(_) => self.has_chunk_index = true,
            Record::Message { header, .. } => {
                *self.counts.entry(header.channel_id).or_default() += 1;
            }
            _ => {}
        }
        Ok(())
    }

    /// Returns the error that the recording is damaged, with this cause.
    pub fn damaged(&self, cause: String) -> Error {
        fault::damaged(&self.path)(cause)
    }

    /// Returns the name under which the recording was opened.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the bytes of the whole file.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Returns the topics in order of their names.
    pub fn topics(&self) -> Vec<TopicInfo> {
        // Many topics may share a schema.
        let mut schemas: BTreeMap<u16, Arc<[u8]>> = BTreeMap::new();
        let topics = self.channels.iter().map(|(id, channel)| {
            let schema = channel.schema.as_ref();
            let data = schema.map(|s| schemas.entry(s.id).or_insert_with(|| (&*s.data).into()));
            TopicInfo {
                name: channel.topic.clone(),
                schema: schema.map_or_else(String::new, |s| s.name.clone()),
                schema_data: data.map_or_else(|| Arc::from([]), |data| Arc::clone(data)),
                encoding: channel.message_encoding.clone(),
                messages: self.counts.get(id).copied().unwrap_or(0),
            }
        });
        let mut topics: Vec<TopicInfo> = topics.collect();
        topics.sort_by(|a, b| a.name.cmp(&b.name));
        topics
    }

    /// Returns all messages in the order of the file, which is the order of time.
    pub fn messages(&self) -> impl Iterator<Item = Result<Message, Error>> + '_ {
        records::messages(&self.bytes).map(|message| {
            let message = message.map_err(fault::damaged(&self.path))?;
            Ok(Message {
                channel: message.channel,
                time_ns: message.log_time.saturating_sub(EPOCH_NS),
                data: message.data.into_owned(),
            })
        })
    }

    /// Returns the attachments in the order of the file.
    pub fn attachments(&self) -> &[Attachment] {
        &self.attachments
    }

    /// Returns the attachment with this name.
    pub fn attachment(&self, name: &str) -> Option<&[u8]> {
        let found = self.attachments.iter().find(|one| one.name == name);
        found.map(|one| one.data.as_slice())
    }

    /// Requires the recording of one episode, or of one run. A program that merges recordings copies the attachments of
    /// all of them.
    ///
    /// # Errors
    /// If two attachments have the same name.
    pub fn require_single(&self) -> Result<(), Error> {
        let mut names = BTreeSet::new();
        let twice = self
            .attachments
            .iter()
            .find(|one| !names.insert(one.name.as_str()));
        twice.map_or(Ok(()), |one| {
            let (file, name) = (self.path.display(), &one.name);
            let message = format!(
                "{file} was merged from several recordings, as it has the attachment {name} more than once: use the \
                 recordings themselves"
            );
            Err(ErrorKind::BadData.error(message))
        })
    }

    /// Returns a metadata record, such as `run`.
    pub fn metadata(&self, name: &str) -> Option<&BTreeMap<String, String>> {
        self.metadata.get(name)
    }

    /// Returns the kind of the recording, if its metadata has one.
    pub fn extent(&self) -> Option<RecordingKind> {
        let entry = self.metadata("run")?.get("episode")?;
        Some(RecordingKind::of_entry(entry))
    }

    /// Returns the kind of the run.
    ///
    /// # Errors
    /// If this version does not know the kind.
    pub fn run_kind(&self) -> Result<RunKind, Error> {
        let kind = self.metadata("run").and_then(|run| run.get(KIND));
        let kind = kind.map(String::as_str);
        RunKind::of_entry(kind).ok_or_else(|| {
            let (file, kind) = (self.path.display(), kind.unwrap_or_default());
            let message = format!(
                "{file} shows a run of the unknown kind `{kind}`: a newer version of xcscr may be able to read it"
            );
            ErrorKind::BadData.error(message)
        })
    }

    /// Returns the number of messages by topic, according to the file's own index.
    pub(super) fn claimed(&self) -> BTreeMap<String, u64> {
        let mut claimed = BTreeMap::new();
        for (id, channel) in &self.channels {
            let own = self.claimed.get(id);
            let sum: &mut u64 = claimed.entry(channel.topic.clone()).or_default();
            *sum = sum.saturating_add(own.copied().unwrap_or(0));
        }
        claimed
    }

    /// Returns true if the file's own index lists chunks.
    pub(super) fn has_chunk_index(&self) -> bool {
        self.has_chunk_index
    }
}

/// Returns true if the name is that of a recording that is still being written.
fn is_unfinished(path: &Path) -> bool {
    path.extension().is_some_and(|end| end == "part")
}
