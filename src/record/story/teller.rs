//! Who tells the story: chapter after chapter, with captions.

use std::collections::BTreeMap;
use std::path::PathBuf;

use foxglove::messages::{FrameTransform, FrameTransforms};
use mcap::{McapError, McapResult};
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
use crate::record::write::sink::Packing;
use crate::world::Maze;

/// What came of a chapter stands for so long after it.
const PAUSE_NS: u64 = 2_000_000_000;
/// In a pause the robot is shown where it is so often; no viewer lets it glide to the next start.
const HOLD_NS: u64 = 500_000_000;
/// The last hold is so long before the pause ends.
const INSTANT_NS: u64 = 1_000_000;
/// For how long the last drive may be shown.
const DRIVE_NS: u64 = 20_000_000_000;

/// A message of the story: its time, topic and bytes.
pub(super) type Told = (u64, Topic, Vec<u8>);

/// Tells a story into memory: a few megabytes.
pub struct Teller<'a> {
    told: Vec<Told>,
    maze: &'a Maze,
    info: RunInfo,
    mode: RecordMode,
    senses: bool,
    /// The learning curve of the whole run, as `/curve` has it.
    curve: Vec<u8>,
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
    /// A story that is to begin, of episodes recorded in this mode, with the learning `curve` of the
    /// run, which is shown from the first moment on; `senses`: is the robot not told where it is?
    pub fn new(
        maze: &'a Maze,
        info: RunInfo,
        mode: RecordMode,
        curve: Vec<u8>,
        senses: bool,
    ) -> Self {
        Self {
            told: Vec::new(),
            maze,
            heading: info.heading(maze.name()),
            info,
            mode,
            senses,
            curve,
            now_ns: 0,
            frames: BTreeMap::new(),
            is_begun: false,
        }
    }

    /// Shows an episode.
    ///
    /// # Errors
    /// When its recording is damaged.
    pub fn chapter(&mut self, chapter: &Chapter, episode: &Recording) -> Result<(), RecordError> {
        let figures = self.play(&chapter.title(false), episode, chapter.most_ns())?;
        let arrows = match chapter.changed {
            0 => "no arrow changed".to_owned(),
            1 => "1 arrow changed".to_owned(),
            changed => format!("{changed} arrows changed"),
        };
        let title = chapter.title(true);
        self.close(&title, &format!("{}; {arrows}", result(&figures)));
        Ok(())
    }

    /// Shows what was learned: an episode that neither learns nor explores.
    ///
    /// # Errors
    /// When its recording is damaged.
    pub fn drive(&mut self, episodes: u32, drive: &Recording) -> Result<(), RecordError> {
        let title = format!("After {episodes} episodes: greedy, exploration off");
        let figures = self.play(&title, drive, DRIVE_NS)?;
        let fewest = match figures.shortest {
            Some(fewest) if figures.steps == Some(fewest) => ", as few as possible".to_owned(),
            Some(fewest) => format!(" ({fewest} would do)"),
            None => String::new(),
        };
        self.close(&title, &format!("{}{fewest}", result(&figures)));
        Ok(())
    }

    /// The story, as the bytes of a file.
    ///
    /// # Errors
    /// None that has been seen: there is room in memory.
    pub fn finish(self) -> Result<Vec<u8>, RecordError> {
        self.written().map_err(unwritten)
    }

    fn written(&self) -> McapResult<Vec<u8>> {
        let (maze, info) = (self.maze, &self.info);
        let mut log = LogFile::new(Vec::new(), Packing::Small)?;
        let metadata = info.metadata(maze.name(), self.mode, Extent::Story);
        log.metadata("run", metadata)?;
        log.attach("world.json", 0, &info.world_json)?;
        log.attach("config.json", 0, &info.config_json)?;
        log.attach("foxglove-layout.json", 0, &layout::of_episode(maze))?;
        log.declare(Extent::Story, &self.topics())?;
        for (time_ns, topic, data) in &self.told {
            log.message(*topic, *time_ns, data)?;
        }
        log.finish()
    }

    /// The topics that the story has.
    pub(super) fn topics(&self) -> Vec<Topic> {
        Topic::of_episode(self.senses, false)
    }

    /// What was told so far.
    pub(super) fn told(&self) -> &[Told] {
        &self.told
    }

    /// How its episodes were recorded.
    pub(super) fn mode(&self) -> RecordMode {
        self.mode
    }

    /// The facts of the run.
    pub(super) fn info(&self) -> &RunInfo {
        &self.info
    }

    /// World, method and seed.
    pub(super) fn heading(&self) -> &str {
        &self.heading
    }

    /// The maze of the run.
    pub(super) fn maze(&self) -> &Maze {
        self.maze
    }

    /// Lets the story that is behind the other stand as it is until both go on.
    pub fn catch_up(&mut self, other: &mut Self) {
        let end_ns = self.now_ns.max(other.now_ns);
        for story in [self, other] {
            if story.now_ns < end_ns {
                story.hold_until(end_ns);
            }
        }
    }

    /// Plays an episode; what it came to.
    fn play(
        &mut self,
        title: &str,
        episode: &Recording,
        most_ns: u64,
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
        if !self.is_begun {
            self.told.push((0, Topic::Curve, self.curve.clone()));
        }
        let remark = match tempo.speed() {
            speed if speed > 1.05 => format!("shown {speed:.1} times as fast"),
            _ => String::new(),
        };
        self.say(title, &remark);
        let damaged = |fault: String| episode.damaged(fault);
        let mut figures = Err(damaged("it has no /episode".to_owned()));
        for message in &messages {
            let topic = Topic::named(message.topic());
            let Some(topic) = topic.filter(|&topic| self.wants(topic)) else {
                continue;
            };
            let data = retimed(topic, &message.data, &tempo).map_err(damaged)?;
            if topic == Topic::Transforms {
                self.follow(&data).map_err(damaged)?;
            } else if topic == Topic::Episode {
                let read = serde_json::from_slice(&message.data);
                figures = read.map_err(|fault| damaged(fault.to_string()));
            }
            self.told.push((tempo.at(message.time_ns), topic, data));
        }
        self.is_begun = true;
        self.now_ns = tempo.end_ns();
        figures
    }

    /// Captions and the curve are the story's own, and what never changes is told once.
    fn wants(&self, topic: Topic) -> bool {
        match topic {
            Topic::Caption | Topic::Curve => false,
            Topic::Maze => !self.is_begun,
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
    fn close(&mut self, title: &str, remark: &str) {
        self.say(title, remark);
        let line = log::told(&format!("{title}: {remark}"), self.now_ns);
        self.told.push((self.now_ns, Topic::Log, encoded(&line)));
        self.hold_until(self.now_ns + PAUSE_NS);
    }

    /// Shows all frames where they were, until a moment.
    fn hold_until(&mut self, end_ns: u64) {
        let begin_ns = self.now_ns;
        let holds = (0..).map(|n| begin_ns + n * HOLD_NS);
        let holds = holds.take_while(|&at_ns| at_ns + INSTANT_NS < end_ns);
        let holds: Vec<u64> = holds.chain([end_ns - INSTANT_NS]).collect();
        for at_ns in holds.into_iter().filter(|&at_ns| at_ns >= begin_ns) {
            self.hold(at_ns);
        }
        self.now_ns = end_ns;
    }

    /// Shows all frames where they were.
    fn hold(&mut self, time_ns: u64) {
        let stay = |frame: &FrameTransform| FrameTransform {
            timestamp: Some(timestamp(time_ns)),
            ..frame.clone()
        };
        let message = FrameTransforms {
            transforms: self.frames.values().map(stay).collect(),
        };
        self.told
            .push((time_ns, Topic::Transforms, encoded(&message)));
    }

    fn say(&mut self, title: &str, remark: &str) {
        let caption = Caption {
            title: title.to_owned(),
            remark: remark.to_owned(),
            heading: self.heading.clone(),
        };
        let scene = encoded(&caption.scene(self.maze, self.now_ns));
        self.told.push((self.now_ns, Topic::Caption, scene));
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

pub(super) fn unwritten(cause: McapError) -> RecordError {
    RecordError::Write {
        path: PathBuf::from(Extent::Story.file_name()),
        cause: cause.to_string(),
    }
}
