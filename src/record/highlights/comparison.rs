//! The highlights of two runs side by side in one recording. The topics and frames of the first run
//! are below `/a`, and those of the second below `/b`.

use std::collections::BTreeMap;
use std::path::Path;

use foxglove::messages::{FrameTransforms, SceneUpdate};
use mcap::McapResult;
use mcap::records::{MessageHeader, Metadata};

use super::builder::{HighlightsBuilder, write_error};
use super::retime::{decoded, encoded};
use crate::record::error::RecordError;
use crate::record::info::RecordingKind;
use crate::record::layout::{self, SIDES};
use crate::record::read::reader::{Message, Recording};
use crate::record::topics::{self, Topic};
use crate::record::write::sink::{self, Packing, Sink};

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
pub fn compare_highlights(
    highlights: [HighlightsBuilder<'_>; 2],
) -> Result<Comparison, RecordError> {
    let [a, b] = &highlights;
    let layout = layout::of_comparison([a.maze(), b.maze()], [a.heading(), b.heading()]);
    let headings = [a.heading(), b.heading()].map(str::to_owned);
    let (mut out, channels) = create(&highlights, &layout).map_err(write_error)?;
    let [a, b] = highlights.map(read_again);
    merge(&[a?, b?], &mut out, &channels)?;
    Ok(Comparison {
        bytes: sink::finish(out).map_err(write_error)?,
        layout,
        headings,
    })
}

/// The channels by side and topic.
type Channels = BTreeMap<(usize, usize), u16>;

/// Creates a file with everything that precedes the first message.
fn create(
    highlights: &[HighlightsBuilder<'_>; 2],
    layout: &str,
) -> McapResult<(Sink<Vec<u8>>, Channels)> {
    let mut out = sink::begin(Vec::new(), Packing::Small)?;
    introduce(&mut out, highlights, layout)?;
    let mut channels = Channels::new();
    for (side, highlights) in highlights.iter().enumerate() {
        for topic in highlights.topics() {
            let schema = topic.schema(RecordingKind::Highlights);
            let id = out.add_schema(&schema.name, &schema.encoding, &schema.data)?;
            let name = format!("/{}{}", SIDES[side], topic.name());
            let encoding = topic.message_encoding();
            let channel = out.add_channel(id, &name, encoding, &BTreeMap::new())?;
            channels.insert((side, topic as usize), channel);
        }
    }
    Ok((out, channels))
}

/// Reads a highlights recording from its packed bytes, so that its messages are never in memory all
/// at once.
fn read_again(highlights: HighlightsBuilder<'_>) -> Result<Recording, RecordError> {
    Recording::from_bytes(
        Path::new(&RecordingKind::Highlights.file_name()),
        highlights.finish()?,
    )
}

/// Writes the messages of both sides in order of time; on ties the first side comes first.
fn merge(
    sides: &[Recording; 2],
    out: &mut Sink<Vec<u8>>,
    channels: &Channels,
) -> Result<(), RecordError> {
    let [a, b] = sides;
    let (mut a, mut b) = (a.messages(), b.messages());
    let mut next = [a.next().transpose()?, b.next().transpose()?];
    loop {
        let (side, message) = match &mut next {
            [None, None] => return Ok(()),
            [Some(first), Some(second)] if second.time_ns < first.time_ns => {
                (1, std::mem::replace(&mut next[1], b.next().transpose()?))
            }
            [Some(_), _] => (0, std::mem::replace(&mut next[0], a.next().transpose()?)),
            [None, Some(_)] => (1, std::mem::replace(&mut next[1], b.next().transpose()?)),
        };
        if let Some(message) = message {
            put(out, channels, side, &message)?;
        }
    }
}

/// Writes a message of a side. Beams, which one run may have recorded, are not part of highlights.
fn put(
    out: &mut Sink<Vec<u8>>,
    channels: &Channels,
    side: usize,
    message: &Message,
) -> Result<(), RecordError> {
    let topic = Topic::named(message.topic());
    let channel = topic.and_then(|topic| Some((topic, *channels.get(&(side, topic as usize))?)));
    let Some((topic, channel_id)) = channel else {
        return Ok(());
    };
    let header = MessageHeader {
        channel_id,
        sequence: 0,
        log_time: message.time_ns,
        publish_time: message.time_ns,
    };
    let data = below(SIDES[side], topic, &message.data);
    out.write_to_known_channel(&header, &data)
        .map_err(write_error)
}

/// Writes the facts of both runs, each below the name of its side.
fn introduce(
    out: &mut Sink<Vec<u8>>,
    highlights: &[HighlightsBuilder<'_>; 2],
    layout: &str,
) -> McapResult<()> {
    let whole = [("episode", RecordingKind::Comparison.to_string())];
    let whole = whole.map(|(key, text)| (key.to_owned(), text));
    metadata(out, "run", whole.into())?;
    for (side, highlights) in SIDES.iter().zip(highlights) {
        let (info, world) = (highlights.info(), highlights.maze().name());
        metadata(
            out,
            side,
            info.metadata(world, highlights.mode(), RecordingKind::Highlights),
        )?;
        attach(out, &format!("{side}/world.json"), &info.world_json)?;
        attach(out, &format!("{side}/config.json"), &info.config_json)?;
    }
    attach(out, "foxglove-layout.json", layout)
}

fn metadata(
    out: &mut Sink<Vec<u8>>,
    name: &str,
    metadata: BTreeMap<String, String>,
) -> McapResult<()> {
    out.write_metadata(&Metadata {
        name: name.to_owned(),
        metadata,
    })
}

fn attach(out: &mut Sink<Vec<u8>>, name: &str, text: &str) -> McapResult<()> {
    out.attach(&mcap::Attachment {
        log_time: 0,
        create_time: 0,
        name: name.to_owned(),
        media_type: "application/json".to_owned(),
        data: text.as_bytes().into(),
    })
}

/// Returns the message with the side's own frame names. Messages without frames are unchanged.
fn below(side: &str, topic: Topic, data: &[u8]) -> Vec<u8> {
    let put = |frame: &mut String| *frame = format!("{side}/{frame}");
    let moved = match topic.message() {
        topics::Message::Frames => decoded(data).map(|mut frames: FrameTransforms| {
            for frame in &mut frames.transforms {
                put(&mut frame.parent_frame_id);
                put(&mut frame.child_frame_id);
            }
            encoded(&frames)
        }),
        topics::Message::Scene => decoded(data).map(|mut scene: SceneUpdate| {
            let frames = scene.entities.iter_mut();
            frames.for_each(|entity| put(&mut entity.frame_id));
            encoded(&scene)
        }),
        topics::Message::Scan | topics::Message::Log | topics::Message::Own(_) => {
            return data.to_vec();
        }
    };
    // Does not fail: a highlights recording only contains messages that could be decoded.
    moved.unwrap_or_else(|_| data.to_vec())
}
