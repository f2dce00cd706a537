//! Two stories side by side, in one recording: topics and frames of the first below `/a`, those of
//! the second below `/b`.

use std::collections::BTreeMap;

use foxglove::messages::{FrameTransforms, SceneUpdate};
use mcap::McapResult;
use mcap::records::{MessageHeader, Metadata};

use super::retime::{decoded, encoded};
use super::teller::{Teller, Told, unwritten};
use crate::record::error::RecordError;
use crate::record::info::Extent;
use crate::record::layout::{self, SIDES};
use crate::record::topics::{Message, Topic};
use crate::record::write::sink::{Packing, Sink};

/// Two stories in one recording.
#[derive(Debug)]
pub struct Comparison {
    /// The recording.
    pub bytes: Vec<u8>,
    /// A layout that shows both sides.
    pub layout: String,
    /// World, method and seed of each side.
    pub headings: [String; 2],
}

/// Puts two stories side by side.
///
/// # Errors
/// None that has been seen: stories can be read, and there is room in memory.
pub fn compare_stories(stories: [&Teller<'_>; 2]) -> Result<Comparison, RecordError> {
    let layout = layout::of_comparison(stories.map(Teller::maze), stories.map(Teller::heading));
    let bytes = merged(stories, &layout).map_err(unwritten)?;
    Ok(Comparison {
        bytes,
        layout,
        headings: stories.map(|story| story.heading().to_owned()),
    })
}

fn merged(stories: [&Teller<'_>; 2], layout: &str) -> McapResult<Vec<u8>> {
    let mut out = Sink::new(Vec::new(), Packing::Small)?;
    introduce(&mut out, stories, layout)?;
    let mut channels = BTreeMap::new();
    for (side, story) in stories.iter().enumerate() {
        for topic in story.topics() {
            let schema = topic.schema(Extent::Story);
            let id = out.add_schema(&schema.name, &schema.encoding, &schema.data)?;
            let name = format!("/{}{}", SIDES[side], topic.name());
            let encoding = topic.message_encoding();
            let channel = out.add_channel(id, &name, encoding, &BTreeMap::new())?;
            channels.insert((side, topic as usize), channel);
        }
    }
    let of_side = |side: usize| stories[side].told().iter().map(move |told| (side, told));
    let mut all: Vec<(usize, &Told)> = of_side(0).chain(of_side(1)).collect();
    all.sort_by_key(|(_, (time_ns, ..))| *time_ns);
    for (side, (time_ns, topic, data)) in all {
        // Beams, which one run may have recorded, are left out, as in any story.
        let Some(&channel_id) = channels.get(&(side, *topic as usize)) else {
            continue;
        };
        let header = MessageHeader {
            channel_id,
            sequence: 0,
            log_time: *time_ns,
            publish_time: *time_ns,
        };
        let data = below(SIDES[side], *topic, data);
        out.message(&header, &data)?;
    }
    out.finish()
}

/// The facts of both runs, those of each below the name of its side.
fn introduce(out: &mut Sink<Vec<u8>>, stories: [&Teller<'_>; 2], layout: &str) -> McapResult<()> {
    let whole = [("episode", Extent::Comparison.to_string())];
    let whole = whole.map(|(key, text)| (key.to_owned(), text));
    metadata(out, "run", whole.into())?;
    for (side, story) in SIDES.iter().zip(stories) {
        let (info, world) = (story.info(), story.maze().name());
        metadata(out, side, info.metadata(world, story.mode(), Extent::Story))?;
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
    out.metadata(&Metadata {
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

/// The message with frames of the side's own; what is in no frame stays as it is.
fn below(side: &str, topic: Topic, data: &[u8]) -> Vec<u8> {
    let put = |frame: &mut String| *frame = format!("{side}/{frame}");
    let moved = match topic.message() {
        Message::Frames => decoded(data).map(|mut frames: FrameTransforms| {
            for frame in &mut frames.transforms {
                put(&mut frame.parent_frame_id);
                put(&mut frame.child_frame_id);
            }
            encoded(&frames)
        }),
        Message::Scene => decoded(data).map(|mut scene: SceneUpdate| {
            let frames = scene.entities.iter_mut();
            frames.for_each(|entity| put(&mut entity.frame_id));
            encoded(&scene)
        }),
        Message::Scan | Message::Log | Message::Own(_) => return data.to_vec(),
    };
    // A story holds only what could be decoded.
    moved.unwrap_or_else(|_| data.to_vec())
}
