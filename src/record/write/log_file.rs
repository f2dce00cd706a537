//! An MCAP file that is being written.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};

use mcap::records::{MessageHeader, Metadata};
use mcap::{Attachment, McapError, McapResult};

use super::sink::{self, Sink};
use super::target::Target;
use crate::disk;
use crate::error::Error;
use crate::record::EPOCH_NS;
use crate::record::error;
use crate::record::info::{RecordingKind, RunInfo};
use crate::record::mode::RecordMode;
use crate::record::topics::Topic;

/// The facts of a run in a recording.
pub struct Facts<'a> {
    pub info: &'a RunInfo,
    /// The name of the world.
    pub world: &'a str,
    pub mode: RecordMode,
    pub kind: RecordingKind,
}

/// An MCAP stream with a fixed set of topics. The same calls produce the same bytes.
pub struct LogFile<W: Write> {
    writer: Sink<W>,
    /// The channel by [`Topic`], if this file has one.
    channels: [Option<u16>; Topic::ALL.len()],
}

impl<W: Write> LogFile<W> {
    /// Begins a file. The topics must be declared before the first message.
    pub fn new(sink: W) -> McapResult<Self> {
        let writer = sink::begin(sink)?;
        Ok(Self {
            writer,
            channels: [None; Topic::ALL.len()],
        })
    }

    /// Writes the facts of a run.
    pub fn facts(&mut self, facts: &Facts<'_>, time_ns: u64) -> McapResult<()> {
        let info = facts.info;
        let metadata = info.metadata(facts.world, facts.mode, facts.kind);
        self.metadata("run", metadata)?;
        self.attach("world.json", time_ns, &info.world_json)?;
        self.attach("config.json", time_ns, &info.config_json)
    }

    /// Declares the topics, so that they exist even without messages.
    pub fn declare(&mut self, topics: &[Topic]) -> McapResult<()> {
        for &topic in topics {
            let schema = topic.schema();
            let id = self
                .writer
                .add_schema(&schema.name, &schema.encoding, &schema.data)?;
            let encoding = topic.message_encoding();
            let channel = self
                .writer
                .add_channel(id, topic.name(), encoding, &BTreeMap::new())?;
            self.channels[topic as usize] = Some(channel);
        }
        Ok(())
    }

    /// Writes a message, unless the file lacks the topic.
    pub fn message(&mut self, topic: Topic, time_ns: u64, encoded: &[u8]) -> McapResult<()> {
        let Some(channel_id) = self.channels[topic as usize] else {
            return Ok(());
        };
        let header = MessageHeader {
            channel_id,
            sequence: 0,
            log_time: EPOCH_NS + time_ns,
            publish_time: EPOCH_NS + time_ns,
        };
        self.writer.write_to_known_channel(&header, encoded)
    }

    /// Attaches a JSON text.
    pub fn attach(&mut self, name: &str, time_ns: u64, text: &str) -> McapResult<()> {
        self.writer.attach(&Attachment {
            log_time: EPOCH_NS + time_ns,
            create_time: EPOCH_NS + time_ns,
            name: name.to_owned(),
            media_type: "application/json".to_owned(),
            data: text.as_bytes().into(),
        })
    }

    /// Writes a metadata record.
    pub fn metadata(&mut self, name: &str, metadata: BTreeMap<String, String>) -> McapResult<()> {
        self.writer.write_metadata(&Metadata {
            name: name.to_owned(),
            metadata,
        })
    }

    /// Writes the indexes and returns the sink.
    pub fn finish(self) -> McapResult<W> {
        sink::finish(self.writer)
    }
}

/// A [`LogFile`] on disk, called `NAME.part` until it is finished; or a complete file, to
/// which the same bytes are written in thought.
pub struct OpenFile {
    log: LogFile<Target>,
    path: PathBuf,
    /// The unfinished file; `None` if the file is complete.
    part: Option<PathBuf>,
}

impl OpenFile {
    /// Creates a file, called `NAME.part` until it is finished, and replaces an older one.
    pub fn create(path: PathBuf) -> Result<Self, Error> {
        let part = disk::part(&path);
        let file = disk::create(&part).map_err(|cause| match cause.kind() {
            // The folder existed when the recorder began.
            io::ErrorKind::NotFound => error::write(&part)(cause),
            _ => disk::cannot_create(&part)(cause),
        })?;
        let target = Target::New(BufWriter::with_capacity(64 * 1024, file));
        let log = LogFile::new(target).map_err(error::write(&part))?;
        Ok(Self {
            log,
            path,
            part: Some(part),
        })
    }

    /// Opens a complete file. Writing anything else than its bytes is an error.
    pub fn complete(path: PathBuf) -> Result<Self, Error> {
        let file = disk::open(&path).map_err(disk::cannot_read(&path))?;
        let log = LogFile::new(Target::Complete(BufReader::new(file)));
        Ok(Self {
            log: log.map_err(error::differs(&path))?,
            path,
            part: None,
        })
    }

    /// Applies an action to the stream; an error names the file.
    pub fn with(
        &mut self,
        act: impl FnOnce(&mut LogFile<Target>) -> McapResult<()>,
    ) -> Result<(), Error> {
        let done = act(&mut self.log);
        done.map_err(|cause| fault(&self.path, self.part.as_deref(), cause))
    }

    /// Finishes the file, syncs it to disk and gives it its name. Returns the path and the size in
    /// bytes.
    pub fn finish(self) -> Result<(PathBuf, u64), Error> {
        let Self { log, path, part } = self;
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
}

/// Returns the error that a file cannot be written, or that a complete file differs.
fn fault(path: &Path, part: Option<&Path>, cause: McapError) -> Error {
    match part {
        Some(part) => error::write(part)(cause),
        None => error::differs(path)(cause),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io;

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
        let mut log = LogFile::new(sink)?;
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
    fn a_message_on_a_topic_that_the_file_lacks_is_left_out() {
        let mut bytes = Vec::new();
        let mut log = LogFile::new(&mut bytes).unwrap();
        log.declare(&[Topic::Log]).unwrap();
        log.message(Topic::Step, 0, b"{}").unwrap();
        log.finish().unwrap();
        let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
        assert_eq!(summary.stats.unwrap().message_count, 0);
    }
}
