//! The highlights of two runs side by side in one recording. The topics and frames of the first run
//! are below `/a`, and those of the second below `/b`.

use std::path::Path;

use mcap::McapResult;

use super::builder::{HighlightsBuilder, write_error};
use crate::error::Error;
use crate::record::info::RecordingKind;
use crate::record::layout::{self, SIDES};
use crate::record::read::reader::Recording;
use crate::record::topics::{Topic, WellKnown};
use crate::record::write::log_file::LogFile;
use crate::record::write::sink::Packing;

/// The highlights of two runs in one recording.
#[derive(Debug)]
pub struct Comparison {
    /// The recording.
    pub bytes: Vec<u8>,
    /// A layout that shows both sides.
    pub layout: String,
    /// World, method, arena, sensor and seed of each side.
    pub headings: [String; 2],
}

/// Combines the highlights of two runs side by side.
///
/// # Errors
/// If a recording cannot be read back or written, which is not expected in memory.
pub fn compare_highlights(highlights: [HighlightsBuilder<'_>; 2]) -> Result<Comparison, Error> {
    let [a, b] = &highlights;
    let headings = [a, b].map(|side| side.run.heading());
    let layout = layout::of_comparison([a.run.maze, b.run.maze], &headings);
    let mut log = create(&highlights, &layout).map_err(write_error)?;
    let [a, b] = highlights.map(read_again);
    merge(&[a?, b?], &mut log)?;
    Ok(Comparison {
        bytes: log.finish().map_err(write_error)?,
        layout,
        headings,
    })
}

/// Creates a file with everything that precedes the first message. The facts and the topics of each
/// run are below the name of its side.
fn create(highlights: &[HighlightsBuilder<'_>; 2], layout: &str) -> McapResult<LogFile<Vec<u8>>> {
    let mut log = LogFile::new(Vec::new(), Packing::Small)?;
    let kind = RecordingKind::Comparison.to_string();
    log.metadata("run", [("episode".to_owned(), kind)].into())?;
    for (side, highlights) in SIDES.iter().zip(highlights) {
        log.facts(&highlights.run.facts(Some(side)), 0)?;
    }
    log.attach("foxglove-layout.json", 0, layout)?;
    for (side, highlights) in highlights.iter().enumerate() {
        let topics = highlights.run.topics();
        log.declare(RecordingKind::Highlights, &topics, Some(side))?;
    }
    Ok(log)
}

/// Reads a highlights recording from its packed bytes, so that its messages are never in memory all
/// at once.
fn read_again(highlights: HighlightsBuilder<'_>) -> Result<Recording, Error> {
    Recording::from_bytes(
        Path::new(&RecordingKind::Highlights.file_name()),
        highlights.finish()?,
    )
}

/// Writes the messages of both sides in order of time; on ties the first side comes first.
fn merge(sides: &[Recording; 2], log: &mut LogFile<Vec<u8>>) -> Result<(), Error> {
    let [mut a, mut b] = sides.each_ref().map(|side| side.messages().peekable());
    loop {
        let side = match (a.peek(), b.peek()) {
            (None, None) => return Ok(()),
            (Some(Ok(a)), Some(Ok(b))) => usize::from(b.time_ns < a.time_ns),
            (None, Some(_)) => 1,
            _ => 0,
        };
        let message = [&mut a, &mut b][side].next().transpose()?;
        let topic = message
            .as_ref()
            .and_then(|message| Topic::named(message.topic()));
        if let Some((message, topic)) = message.as_ref().zip(topic) {
            let data = below(SIDES[side], topic, &message.data);
            let written = log.message_at(side, topic, message.time_ns, &data);
            written.map_err(write_error)?;
        }
    }
}

/// Returns the message with the side's own frame names. Messages without frames are unchanged.
fn below(side: &str, topic: Topic, data: &[u8]) -> Vec<u8> {
    // Does not fail: a highlights recording only contains messages that could be decoded.
    let Ok(Some(mut message)) = WellKnown::decode(topic, data) else {
        return data.to_vec();
    };
    for frame in message.frames() {
        *frame = format!("{side}/{frame}");
    }
    message.encode()
}
