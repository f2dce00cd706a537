//! Who tells the story: chapter after chapter, with captions.

use std::collections::BTreeMap;
use std::path::PathBuf;

use foxglove::messages::{FrameTransform, FrameTransforms};
use mcap::McapError;
use serde::Deserialize;

use super::chapter::Chapter;
use super::retime::{Tempo, decoded, encoded, retimed};
use crate::record::error::RecordError;
use crate::record::info::{Extent, RunInfo};
use crate::record::layout;
use crate::record::mode::RecordMode;
use crate::record::read::reader::{Message, Recording};
use crate::record::topics::caption::Caption;
use crate::record::topics::{Topic, log, timestamp};
use crate::record::write::log_file::LogFile;
use crate::world::Maze;

/// What came of a chapter stands for so long after it.
const PAUSE_NS: u64 = 2_000_000_000;
/// In a pause the robot is shown where it is so often; no viewer lets it glide to the next start.
const HOLD_NS: u64 = 500_000_000;
/// The last hold is so long before the pause ends.
const INSTANT_NS: u64 = 1_000_000;
/// For how long the last drive may be shown.
const DRIVE_NS: u64 = 20_000_000_000;

/// Writes a story into memory: a few hundred kilobytes.
pub struct Teller<'a> {
    log: LogFile<Vec<u8>>,
    maze: &'a Maze,
    heading: String,
    now_ns: u64,
    /// Where each frame was last.
    frames: BTreeMap<String, FrameTransform>,
    is_begun: bool,
}

/// The fields of `/episode` that count here.
#[derive(Deserialize)]
struct Figures {
    outcome: String,
    steps: Option<u32>,
    collisions: Option<u32>,
    shortest: Option<u32>,
}

impl<'a> Teller<'a> {
    /// A story that is to begin; `senses`: is the robot not told where it is?
    ///
    /// # Errors
    /// None that has been seen: there is room in memory.
    pub fn new(maze: &'a Maze, info: &RunInfo, senses: bool) -> Result<Self, RecordError> {
        let begin = || {
            let mut log = LogFile::new(Vec::new())?;
            let metadata = info.metadata(maze.name(), RecordMode::All, Extent::Story);
            log.metadata("run", metadata)?;
            log.attach("world.json", 0, &info.world_json)?;
            log.attach("config.json", 0, &info.config_json)?;
            log.attach("foxglove-layout.json", 0, &layout::of_episode(maze))?;
            log.declare(Topic::of_episode(senses, false))?;
            Ok(log)
        };
        Ok(Self {
            log: begin().map_err(unwritten)?,
            maze,
            heading: info.heading(maze.name()),
            now_ns: 0,
            frames: BTreeMap::new(),
            is_begun: false,
        })
    }

    /// Shows an episode.
    ///
    /// # Errors
    /// When its recording is damaged.
    pub fn chapter(&mut self, chapter: &Chapter, episode: &Recording) -> Result<(), RecordError> {
        let figures = self.play(&chapter.title(), episode, chapter.most_ns(), &[])?;
        let arrows = match chapter.changed {
            0 => "no arrow changed".to_owned(),
            1 => "1 arrow changed".to_owned(),
            changed => format!("{changed} arrows changed"),
        };
        self.close(&chapter.title(), &format!("{}; {arrows}", result(&figures)))
    }

    /// Shows what was learned: an episode that neither learns nor explores.
    ///
    /// # Errors
    /// When its recording is damaged.
    pub fn drive(&mut self, episodes: u32, drive: &Recording) -> Result<(), RecordError> {
        let title = format!("After {episodes} episodes: greedy, exploration off");
        // Of all topics, only the learning curve is about what came before.
        let figures = self.play(&title, drive, DRIVE_NS, &[Topic::Curve])?;
        let fewest = match figures.shortest {
            Some(fewest) if figures.steps == Some(fewest) => ", as few as possible".to_owned(),
            Some(fewest) => format!(" ({fewest} would do)"),
            None => String::new(),
        };
        self.close(&title, &format!("{}{fewest}", result(&figures)))
    }

    /// The story, as the bytes of a file.
    ///
    /// # Errors
    /// None that has been seen: there is room in memory.
    pub fn finish(self) -> Result<Vec<u8>, RecordError> {
        self.log.finish().map_err(unwritten)
    }

    /// Plays an episode without some of its topics; what it came to.
    fn play(
        &mut self,
        title: &str,
        episode: &Recording,
        most_ns: u64,
        without: &[Topic],
    ) -> Result<Figures, RecordError> {
        let messages: Result<Vec<Message>, _> = episode.messages().collect();
        let messages = messages?;
        let times = || messages.iter().map(|message| message.time_ns);
        let from_ns = times().min().unwrap_or(0);
        let length_ns = times().max().unwrap_or(0) - from_ns;
        let tempo = Tempo {
            from_ns,
            length_ns,
            begin_ns: self.now_ns,
            shown_ns: length_ns.min(most_ns),
        };
        let remark = match tempo.speed() {
            speed if speed > 1.05 => format!("shown {speed:.1} times as fast"),
            _ => String::new(),
        };
        self.say(title, &remark)?;
        let damaged = |fault: String| episode.damaged(fault);
        let mut figures = Err(damaged("it has no /episode".to_owned()));
        for message in &messages {
            let topic = Topic::named(message.topic()).filter(|topic| !without.contains(topic));
            let Some(topic) = topic.filter(|&topic| self.wants(topic)) else {
                continue;
            };
            let data = retimed(topic, &message.data, &tempo).map_err(damaged)?;
            self.write(topic, tempo.at(message.time_ns), &data)?;
            if topic == Topic::Transforms {
                self.follow(&data).map_err(damaged)?;
            } else if topic == Topic::Episode {
                let read = serde_json::from_slice(&message.data);
                figures = read.map_err(|fault| damaged(fault.to_string()));
            }
        }
        self.is_begun = true;
        self.now_ns = tempo.end_ns();
        figures
    }

    /// Captions are the story's own, and what never changes is told once.
    fn wants(&self, topic: Topic) -> bool {
        match topic {
            Topic::Caption => false,
            Topic::Maze | Topic::Robot => !self.is_begun,
            _ => true,
        }
    }

    /// Remembers where each frame is.
    fn follow(&mut self, data: &[u8]) -> Result<(), String> {
        let message: FrameTransforms = decoded(data)?;
        let named = message.transforms.into_iter();
        self.frames
            .extend(named.map(|frame| (frame.child_frame_id.clone(), frame)));
        Ok(())
    }

    /// Says what came of a chapter, while nothing moves.
    fn close(&mut self, title: &str, remark: &str) -> Result<(), RecordError> {
        self.say(title, remark)?;
        let line = log::told(&format!("{title}: {remark}"), self.now_ns);
        self.write(Topic::Log, self.now_ns, &encoded(&line))?;
        let end_ns = self.now_ns + PAUSE_NS;
        let holds = (0..).map(|n| n * HOLD_NS).take_while(|&at| at < PAUSE_NS);
        let holds = holds.chain([PAUSE_NS - INSTANT_NS]);
        let begin_ns = self.now_ns;
        for after_ns in holds {
            self.hold(begin_ns + after_ns)?;
        }
        self.now_ns = end_ns;
        Ok(())
    }

    /// Shows all frames where they were.
    fn hold(&mut self, time_ns: u64) -> Result<(), RecordError> {
        let stay = |frame: &FrameTransform| FrameTransform {
            timestamp: Some(timestamp(time_ns)),
            ..frame.clone()
        };
        let message = FrameTransforms {
            transforms: self.frames.values().map(stay).collect(),
        };
        self.write(Topic::Transforms, time_ns, &encoded(&message))
    }

    fn say(&mut self, title: &str, remark: &str) -> Result<(), RecordError> {
        let caption = Caption {
            title: title.to_owned(),
            remark: remark.to_owned(),
            heading: self.heading.clone(),
        };
        let scene = encoded(&caption.scene(self.maze, self.now_ns));
        self.write(Topic::Caption, self.now_ns, &scene)
    }

    fn write(&mut self, topic: Topic, time_ns: u64, data: &[u8]) -> Result<(), RecordError> {
        self.log.message(topic, time_ns, data).map_err(unwritten)
    }
}

/// What an episode came to, in words.
fn result(figures: &Figures) -> String {
    let how = match figures.outcome.as_str() {
        "goal" => "reached the goal",
        _ => "gave up",
    };
    let (steps, hits) = (figures.steps.unwrap_or(0), figures.collisions.unwrap_or(0));
    format!("{how} after {steps} steps, {hits} collisions")
}

fn unwritten(cause: McapError) -> RecordError {
    RecordError::Write {
        path: PathBuf::from(Extent::Story.file_name()),
        cause: cause.to_string(),
    }
}
