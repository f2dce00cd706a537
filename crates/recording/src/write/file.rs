//! An MCAP file that is being written.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, BufReader, BufWriter, Read, Write};
use std::path::{Path, PathBuf};

use foxglove::Encode;
use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{Attachment, Compression, MAGIC, McapError, McapResult, WriteOptions, Writer};
use serde::Serialize;

use super::target::Target;
use crate::disk;
use crate::error::Error;
use crate::topics::Topic;
use crate::{EPOCH_NS, event, fault};

/// Uncompressed size at which a chunk is closed, in bytes.
const CHUNK_BYTES: u64 = 512 * 1024;
/// The level of compression: as high as is worthwhile.
const LEVEL: u32 = 8;
/// The library name in the header.
const LIBRARY: &str = concat!("xcscr/", env!("CARGO_PKG_VERSION"));

/// Returns true if the file is a recording written by any version of this program.
///
/// # Errors
/// If the file cannot be read.
pub fn is_ours(path: &Path) -> io::Result<bool> {
    let mut begin = Vec::new();
    disk::open(path)?.take(64).read_to_end(&mut begin)?;
    let writer = b"xcscr/";
    let names_us = begin.windows(writer.len()).any(|bytes| bytes == writer);
    Ok(begin.starts_with(MAGIC) && names_us)
}

/// An MCAP stream with a fixed set of topics. The same calls produce the same bytes.
struct Log<W: Write> {
    writer: Writer<NoSeek<W>>,
    /// The channel by [`Topic`], if this file has one.
    channels: [Option<u16>; Topic::ALL.len()],
}

impl<W: Write> Log<W> {
    fn new(out: W) -> McapResult<Self> {
        let options = WriteOptions::new()
            .library(LIBRARY)
            .chunk_size(Some(CHUNK_BYTES))
            .compression(Some(Compression::Zstd))
            .compression_level(LEVEL)
            // Compression threads would change the bytes.
            .compression_threads(0)
            .emit_summary_offsets(false)
            .disable_seeking(true);
        Ok(Self {
            writer: options.create(NoSeek::new(out))?,
            channels: [None; Topic::ALL.len()],
        })
    }

    fn declare(&mut self, topics: &[Topic]) -> McapResult<()> {
        for &topic in topics {
            let schema = topic.schema();
            let (name, language) = (&schema.name, &schema.encoding);
            let id = self.writer.add_schema(name, language, &schema.data)?;
            let encoding = topic.message_encoding();
            let none = BTreeMap::new();
            let channel = self.writer.add_channel(id, topic.name(), encoding, &none)?;
            self.channels[topic as usize] = Some(channel);
        }
        Ok(())
    }

    fn message(&mut self, topic: Topic, time_ns: u64, encoded: &[u8]) -> McapResult<()> {
        let unknown = McapError::UnknownChannel(0, topic as u16);
        let header = MessageHeader {
            channel_id: self.channels[topic as usize].ok_or(unknown)?,
            sequence: 0,
            log_time: EPOCH_NS + time_ns,
            publish_time: EPOCH_NS + time_ns,
        };
        self.writer.write_to_known_channel(&header, encoded)
    }

    fn attach(&mut self, name: &str, time_ns: u64, text: &str) -> McapResult<()> {
        self.writer.attach(&Attachment {
            log_time: EPOCH_NS + time_ns,
            create_time: EPOCH_NS + time_ns,
            name: name.to_owned(),
            media_type: "application/json".to_owned(),
            data: text.as_bytes().into(),
        })
    }

    fn finish(mut self) -> McapResult<W> {
        self.writer.finish()?;
        Ok(self.writer.into_inner().into_inner())
    }
}

/// A recording on disk, called `NAME.part` until it is finished; or a complete recording, to which
/// the same bytes are written only in thought. Errors name the file.
pub struct File {
    log: Log<Target>,
    path: PathBuf,
    /// The unfinished file; `None` if the file is complete.
    part: Option<PathBuf>,
    scratch: Vec<u8>,
}

impl File {
    /// Creates a file, called `NAME.part` until it is finished, and replaces an older one.
    pub fn create(path: PathBuf) -> Result<Self, Error> {
        let part = disk::part(&path);
        let file = disk::create(&part).map_err(|cause| match cause.kind() {
            // The folder existed when the recorder began.
            io::ErrorKind::NotFound => fault::cannot_write(&part)(cause),
            _ => disk::cannot_create(&part)(cause),
        })?;
        let target = Target::New(BufWriter::with_capacity(64 * 1024, file));
        Self::begin(target, path, Some(part))
    }

    /// Opens a complete file. Writing anything else than its bytes is an error.
    pub fn complete(path: PathBuf) -> Result<Self, Error> {
        let file = disk::open(&path).map_err(disk::cannot_read(&path))?;
        Self::begin(Target::Complete(BufReader::new(file)), path, None)
    }

    fn begin(target: Target, path: PathBuf, part: Option<PathBuf>) -> Result<Self, Error> {
        let log = Log::new(target).map_err(|cause| fault(&path, part.as_deref(), cause))?;
        Ok(Self {
            log,
            path,
            part,
            scratch: Vec::new(),
        })
    }

    /// Declares the topics, so that they exist even without messages.
    pub fn declare(&mut self, topics: &[Topic]) -> Result<(), Error> {
        let done = self.log.declare(topics);
        self.named(done)
    }

    /// Writes a well-known message on a declared topic.
    pub fn message(
        &mut self,
        topic: Topic,
        time_ns: u64,
        message: &impl Encode,
    ) -> Result<(), Error> {
        self.scratch.clear();
        message
            .encode(&mut self.scratch)
            .expect("a vector has room for any message");
        let done = self.log.message(topic, time_ns, &self.scratch);
        self.named(done)
    }

    /// Writes a fact on a declared topic.
    pub fn fact(&mut self, topic: Topic, time_ns: u64, fact: &impl Serialize) -> Result<(), Error> {
        self.scratch.clear();
        event::write_json(&mut self.scratch, fact);
        let done = self.log.message(topic, time_ns, &self.scratch);
        self.named(done)
    }

    /// Attaches a JSON text.
    pub fn attach(&mut self, name: &str, time_ns: u64, text: &str) -> Result<(), Error> {
        let done = self.log.attach(name, time_ns, text);
        self.named(done)
    }

    /// Writes a metadata record.
    pub fn metadata(
        &mut self,
        name: &str,
        metadata: BTreeMap<String, String>,
    ) -> Result<(), Error> {
        let name = name.to_owned();
        let done = self.log.writer.write_metadata(&Metadata { name, metadata });
        self.named(done)
    }

    /// Finishes the file, syncs it to disk and gives it its name. Returns the path and the size in
    /// bytes.
    pub fn finish(self) -> Result<(PathBuf, u64), Error> {
        let Self {
            log, path, part, ..
        } = self;
        let saved = log.finish().and_then(|target| {
            let bytes = target.finish()?;
            if let Some(part) = &part {
                fs::rename(part, &path)?;
            }
            Ok(bytes)
        });
        let bytes = saved.map_err(|cause| fault(&path, part.as_deref(), cause))?;
        Ok((path, bytes))
    }

    fn named(&self, done: McapResult<()>) -> Result<(), Error> {
        done.map_err(|cause| fault(&self.path, self.part.as_deref(), cause))
    }
}

/// Returns the error that a file cannot be written, or that a complete file differs.
fn fault(path: &Path, part: Option<&Path>, cause: McapError) -> Error {
    match part {
        Some(part) => fault::cannot_write(part)(cause),
        None => fault::unlike_repeated_run(path)(cause),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sink that accepts this many bytes and then fails.
    struct Full {
        room: usize,
    }

    impl Write for Full {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let taken = bytes.len().min(self.room);
            self.room -= taken;
            match taken {
                0 if !bytes.is_empty() => Err(io::ErrorKind::StorageFull.into()),
                _ => Ok(taken),
            }
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    fn write_to(sink: impl Write) -> McapResult<()> {
        let mut log = Log::new(sink)?;
        log.attach("world.json", 0, "{}")?;
        log.declare(Topic::ALL)?;
        for time_ns in 0..50 {
            log.message(Topic::Step, time_ns, b"{}")?;
        }
        log.message(Topic::Log, 50, b"")?;
        log.finish().map(|_| ())
    }

    #[test]
    fn a_disk_that_fills_up_anywhere_is_an_error_and_no_panic() {
        let mut whole = Vec::new();
        write_to(&mut whole).unwrap();
        for room in (0..whole.len()).step_by(53) {
            assert!(write_to(Full { room }).is_err(), "{room} bytes were enough");
        }
        assert!(write_to(Full { room: whole.len() }).is_ok());
    }

    #[test]
    fn a_message_on_a_topic_that_the_file_lacks_is_an_error() {
        let mut log = Log::new(Vec::new()).unwrap();
        log.declare(&[Topic::Log]).unwrap();
        assert!(log.message(Topic::Step, 0, b"{}").is_err());
        assert!(log.message(Topic::Log, 0, b"").is_ok(), "control");
    }
}
