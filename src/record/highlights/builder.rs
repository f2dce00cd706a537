//! Builds a highlights recording segment by segment, with captions.

use std::collections::BTreeMap;
use std::path::Path;

use foxglove::messages::{FrameTransform, FrameTransforms};
use mcap::{McapError, McapResult};

use super::retime::{Tempo, retimed};
use super::segment::Segment;
use crate::error::Error;
use crate::record::error;
use crate::record::info::{RecordingKind, RunInfo};
use crate::record::layout;
use crate::record::mode::RecordMode;
use crate::record::read::episodes::Figures;
use crate::record::read::reader::Recording;
use crate::record::topics::caption::Caption;
use crate::record::topics::{Topic, decoded, encoded, log, timestamp};
use crate::record::write::log_file::{Facts, LogFile};
use crate::record::write::sink::Packing;
use crate::world::Maze;

/// The result of a segment is shown for this time after the segment.
const PAUSE_NS: u64 = 2_000_000_000;
/// The interval of poses in a pause. Frequent poses keep viewers from interpolating to the next
/// start.
const HOLD_NS: u64 = 500_000_000;
/// The time from the last repeated pose to the end of the pause.
const INSTANT_NS: u64 = 1_000_000;
/// The maximum duration of the last drive.
const DRIVE_NS: u64 = 20_000_000_000;

/// The maximum number of messages per topic that are shown of an episode: 100 a second if the
/// episode is shown for 20 s, which is more than viewers draw. Of longer episodes, every second or every
/// third message is shown, and so on. The size of the highlights recording thus does not depend on
/// the number of steps.
pub(super) const MAX_SHOWN: u64 = 2_000;

/// A run that is shown.
pub struct ShownRun<'a> {
    pub maze: &'a Maze,
    pub info: RunInfo,
    /// The mode in which the episodes were recorded.
    pub mode: RecordMode,
    /// True if the robot estimates its pose.
    pub senses: bool,
}

impl ShownRun<'_> {
    /// Returns world, method, arena, sensor and seed.
    pub(super) fn heading(&self) -> String {
        self.info.heading(self.maze.name())
    }

    /// Returns the topics of the recording.
    pub(super) fn topics(&self) -> Vec<Topic> {
        Topic::of_episode(self.senses, false)
    }

    /// Returns the facts of the run, for its own recording or for a side of a comparison.
    pub(super) fn facts<'b>(&'b self, side: Option<&'b str>) -> Facts<'b> {
        Facts {
            info: &self.info,
            world: self.maze.name(),
            mode: self.mode,
            kind: RecordingKind::Highlights,
            side,
        }
    }
}

/// Builds a highlights recording in memory, as the packed bytes of its file.
pub struct HighlightsBuilder<'a> {
    log: LogFile<Vec<u8>>,
    pub(super) run: ShownRun<'a>,
    /// The learning curve of the whole run, as a message of `/curve`.
    curve: Vec<u8>,
    now_ns: u64,
    /// The last pose of each frame.
    frames: BTreeMap<String, FrameTransform>,
    is_begun: bool,
}

impl<'a> HighlightsBuilder<'a> {
    /// Begins a recording. The learning `curve` of the whole run is shown from the start.
    ///
    /// # Errors
    /// If the header cannot be encoded, which is not expected in memory.
    pub fn new(run: ShownRun<'a>, curve: Vec<u8>) -> Result<Self, Error> {
        Ok(Self {
            log: create_log(&run).map_err(write_error)?,
            run,
            curve,
            now_ns: 0,
            frames: BTreeMap::new(),
            is_begun: false,
        })
    }

    /// Adds an episode.
    ///
    /// # Errors
    /// If its recording is damaged.
    pub fn segment(&mut self, segment: &Segment, episode: &Recording) -> Result<(), Error> {
        let figures = self.play(&segment.title(false), episode, segment.most_ns(), None)?;
        let arrows = match segment.changed {
            0 => "no arrow changed".to_owned(),
            1 => "1 arrow changed".to_owned(),
            changed => format!("{changed} arrows changed"),
        };
        let title = segment.title(true);
        self.close(&title, &format!("{}; {arrows}", result(&figures)))
    }

    /// Adds the drive of the learned policy: an episode without learning and exploration.
    ///
    /// # Errors
    /// If its recording is damaged.
    pub fn drive(&mut self, episodes: u32, drive: &Recording) -> Result<(), Error> {
        let title = format!("After {episodes} episodes: greedy, exploration off");
        let figures = self.play(&title, drive, DRIVE_NS, Some(episodes))?;
        let fewest = match figures.shortest {
            Some(fewest) if figures.steps == Some(fewest) => ", as few as possible".to_owned(),
            Some(fewest) => format!(" ({fewest} would do)"),
            None => String::new(),
        };
        self.close(&title, &format!("{}{fewest}", result(&figures)))
    }

    /// Returns the recording as the bytes of a file.
    ///
    /// # Errors
    /// If the index cannot be encoded, which is not expected in memory.
    pub fn finish(self) -> Result<Vec<u8>, Error> {
        self.log.finish().map_err(write_error)
    }

    /// Extends the shorter of two recordings with its last poses to the length of the other.
    ///
    /// # Errors
    /// If a message cannot be encoded, which is not expected in memory.
    pub fn catch_up(&mut self, other: &mut Self) -> Result<(), Error> {
        let end_ns = self.now_ns.max(other.now_ns);
        for highlights in [self, other] {
            if highlights.now_ns < end_ns {
                highlights.hold_until(end_ns)?;
            }
        }
        Ok(())
    }

    /// Copies an episode and returns its figures. A `number` replaces the episode's own number.
    fn play(
        &mut self,
        title: &str,
        episode: &Recording,
        most_ns: u64,
        number: Option<u32>,
    ) -> Result<Figures, Error> {
        let length = Length::of(episode)?;
        let tempo = Tempo {
            from_ns: length.from_ns,
            length_ns: length.to_ns.saturating_sub(length.from_ns),
            begin_ns: self.now_ns,
            shown_ns: length.to_ns.saturating_sub(length.from_ns).min(most_ns),
            episode: number,
        };
        if !self.is_begun {
            let curve = self.curve.clone();
            self.write(0, Topic::Curve, &curve)?;
        }
        let remark = match tempo.speed() {
            speed if speed > 1.05 => format!("shown {speed:.1} times as fast"),
            _ => String::new(),
        };
        self.show_caption(title, &remark)?;
        let damaged = |fault: String| episode.damaged(fault);
        let mut figures = Err(damaged("it has no /episode".to_owned()));
        let mut numbers = [0; Topic::ALL.len()];
        for message in episode.messages() {
            let message = message?;
            let topic = Topic::named(message.topic());
            let Some(topic) = topic.filter(|&topic| self.wants(topic)) else {
                continue;
            };
            let count = &mut numbers[topic as usize];
            *count += 1;
            if !length.shows(topic, *count) {
                continue;
            }
            let data = retimed(topic, &message.data, &tempo).map_err(damaged)?;
            if topic == Topic::Transforms {
                self.follow(&data).map_err(damaged)?;
            } else if topic == Topic::Episode {
                figures = episode.figures(&message);
            }
            self.write(tempo.at(message.time_ns), topic, &data)?;
        }
        self.is_begun = true;
        self.now_ns = tempo.end_ns();
        figures
    }

    /// Returns true if a topic of an episode is copied. Captions and the curve are the recording's
    /// own, and the maze is written once.
    fn wants(&self, topic: Topic) -> bool {
        match topic {
            Topic::Caption | Topic::Curve => false,
            Topic::Maze => !self.is_begun,
            _ => true,
        }
    }

    /// Stores the pose of each frame.
    fn follow(&mut self, data: &[u8]) -> Result<(), String> {
        let message: FrameTransforms = decoded(data)?;
        let named = message.transforms.into_iter();
        self.frames
            .extend(named.map(|frame| (frame.child_frame_id.clone(), frame)));
        Ok(())
    }

    /// Shows the result of a segment while nothing moves.
    fn close(&mut self, title: &str, remark: &str) -> Result<(), Error> {
        self.show_caption(title, remark)?;
        let line = log::segment(&format!("{title}: {remark}"), self.now_ns);
        self.write(self.now_ns, Topic::Log, &encoded(&line))?;
        self.hold_until(self.now_ns + PAUSE_NS)
    }

    /// Repeats the last poses of all frames until a time.
    fn hold_until(&mut self, end_ns: u64) -> Result<(), Error> {
        let begin_ns = self.now_ns;
        let holds = (0..).map(|n| begin_ns + n * HOLD_NS);
        let holds = holds.take_while(|&at_ns| at_ns + INSTANT_NS < end_ns);
        let holds: Vec<u64> = holds.chain([end_ns - INSTANT_NS]).collect();
        for at_ns in holds.into_iter().filter(|&at_ns| at_ns >= begin_ns) {
            self.hold(at_ns)?;
        }
        self.now_ns = end_ns;
        Ok(())
    }

    /// Repeats the last poses of all frames once.
    fn hold(&mut self, time_ns: u64) -> Result<(), Error> {
        let stay = |frame: &FrameTransform| FrameTransform {
            timestamp: Some(timestamp(time_ns)),
            ..frame.clone()
        };
        let message = FrameTransforms {
            transforms: self.frames.values().map(stay).collect(),
        };
        self.write(time_ns, Topic::Transforms, &encoded(&message))
    }

    fn show_caption(&mut self, title: &str, remark: &str) -> Result<(), Error> {
        let caption = Caption {
            title: title.to_owned(),
            remark: remark.to_owned(),
            heading: self.run.heading(),
        };
        let scene = encoded(&caption.scene(self.run.maze, self.now_ns));
        self.write(self.now_ns, Topic::Caption, &scene)
    }

    fn write(&mut self, time_ns: u64, topic: Topic, data: &[u8]) -> Result<(), Error> {
        let written = self.log.message(topic, time_ns, data);
        written.map_err(write_error)
    }
}

/// Creates a file with everything that precedes the first message.
fn create_log(run: &ShownRun<'_>) -> McapResult<LogFile<Vec<u8>>> {
    let mut log = LogFile::new(Vec::new(), Packing::Small)?;
    log.facts(&run.facts(None), 0)?;
    log.attach("foxglove-layout.json", 0, &layout::of_episode(run.maze))?;
    log.declare(RecordingKind::Highlights, &run.topics(), None)?;
    Ok(log)
}

/// The duration and the size of a recorded episode.
struct Length {
    from_ns: u64,
    to_ns: u64,
    /// The number of messages by [`Topic`].
    messages: [u64; Topic::ALL.len()],
}

impl Length {
    fn of(episode: &Recording) -> Result<Self, Error> {
        let (mut from_ns, mut to_ns) = (u64::MAX, 0);
        let mut messages = [0; Topic::ALL.len()];
        for message in episode.messages() {
            let message = message?;
            from_ns = from_ns.min(message.time_ns);
            to_ns = to_ns.max(message.time_ns);
            if let Some(topic) = Topic::named(message.topic()) {
                messages[topic as usize] += 1;
            }
        }
        Ok(Self {
            from_ns: from_ns.min(to_ns),
            to_ns,
            messages,
        })
    }

    /// Returns true if message `number` of a topic, from 1, is shown. The first and the last one
    /// always are.
    fn shows(&self, topic: Topic, number: u64) -> bool {
        let all = self.messages[topic as usize];
        let every = all.div_ceil(MAX_SHOWN).max(1);
        (number - 1).is_multiple_of(every) || number == all
    }
}

/// Returns the result of an episode as text.
fn result(figures: &Figures) -> String {
    let how = match figures.outcome.as_str() {
        "goal" => "reached the goal",
        _ => "gave up",
    };
    let (steps, hits) = (figures.steps.unwrap_or(0), figures.collisions.unwrap_or(0));
    format!("{how} after {steps} steps, {hits} collisions")
}

pub(super) fn write_error(cause: McapError) -> Error {
    error::write(Path::new(&RecordingKind::Highlights.file_name()))(cause)
}
