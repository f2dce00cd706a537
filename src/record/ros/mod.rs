//! Recordings for ROS 2: messages in its own encoding, for `ros2 bag` and rviz.
//!
//! The frames are those of a real robot (REP 105): `map`, `odom` and `base_link`. Where the robot really
//! is, which no robot knows, is told on `/ground_truth/odom` alone.

mod dead_reckoning;
mod messages;
mod schemas;
mod turn;

use std::io::Cursor;
use std::ops::ControlFlow;

use byteorder::LittleEndian;
use mcap::records::MessageHeader;
use mcap::{Compression, McapError, McapResult, WriteOptions, Writer};
use nalgebra::Isometry2;
use serde::Serialize;

use crate::arena::{Estimate, LidarParams, Sample, View};
use crate::episode::{Episode, Learned, Observer, Step};
use crate::record::error::RecordError;
use dead_reckoning::DeadReckoning;
use messages::{
    BASE, EstimatedPose, LASER, MAP, ODOM, OccupancyGrid, Odometry, TRUE_BASE, Transforms,
};
use schemas::{GRID, Interface, ODOMETRY, POSE, SCAN, TRANSFORMS};
use turn::Turns;

/// What precedes a message: its byte order, little-endian, and no options.
const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];
const LIBRARY: &str = concat!("xcscr/", env!("CARGO_PKG_VERSION"));

/// The quality of service that the topic was offered with, as rosbag2 writes it up to version 8 of its
/// metadata, in the numbers of rmw: the last messages, as many as `depth`, reliably, and for those who
/// subscribe later only if it is transient-local (durability 1; 2 is volatile). No deadlines.
macro_rules! qos {
    ($depth:literal, $durability:literal) => {
        concat!(
            "- history: 1\n  depth: ", $depth, "\n  reliability: 1\n  durability: ", $durability,
            "\n  deadline:\n    sec: 9223372036\n    nsec: 854775807\n  lifespan:\n    sec: 9223372036\n    \
             nsec: 854775807\n  liveliness: 1\n  liveliness_lease_duration:\n    sec: 9223372036\n    \
             nsec: 854775807\n  avoid_ros_namespace_conventions: false"
        )
    };
}
const VOLATILE: &str = qos!(10, 2);
const TRANSIENT_LOCAL: &str = qos!(1, 1);

/// A topic of the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Topic {
    Tf,
    TfStatic,
    Odom,
    Pose,
    Scan,
    Map,
    GroundTruth,
}

/// The topics in the order of [`Topic`]: name, type and quality of service.
const TOPICS: [(&str, Interface, &str); 7] = [
    ("/tf", TRANSFORMS, VOLATILE),
    ("/tf_static", TRANSFORMS, TRANSIENT_LOCAL),
    ("/odom", ODOMETRY, VOLATILE),
    ("/pose", POSE, VOLATILE),
    ("/scan", SCAN, VOLATILE),
    ("/map", GRID, TRANSIENT_LOCAL),
    ("/ground_truth/odom", ODOMETRY, VOLATILE),
];

type Sink = Writer<Cursor<Vec<u8>>>;

/// A file with its topics, and their channels.
fn begun() -> McapResult<(Sink, [u16; TOPICS.len()])> {
    let mut writer = WriteOptions::new()
        .compression(Some(Compression::Zstd))
        .compression_threads(0)
        .profile("ros2")
        .library(LIBRARY)
        .create(Cursor::new(Vec::new()))?;
    let mut channels = [0; TOPICS.len()];
    for (channel, (topic, Interface { name, definition }, qos)) in channels.iter_mut().zip(TOPICS) {
        let schema = writer.add_schema(name, "ros2msg", definition.as_bytes())?;
        let metadata = [("offered_qos_profiles".to_owned(), qos.to_owned())].into();
        *channel = writer.add_channel(schema, topic, "cdr", &metadata)?;
    }
    Ok((writer, channels))
}

fn unwritten(cause: McapError) -> RecordError {
    RecordError::Write {
        path: "the recording for ROS 2".into(),
        cause: cause.to_string(),
    }
}

/// The robot, as far as a file for ROS 2 needs it.
#[derive(Debug, Clone)]
pub struct RosRobot {
    /// The distance between its wheels in metres; `None` where it moves without wheels.
    pub wheel_base_m: Option<f64>,
    /// Its lidar.
    pub lidar: LidarParams,
    /// As far as the lidar sees, in metres.
    pub range_max_m: f64,
}

/// Watches episodes and writes what a ROS 2 robot would have recorded.
pub struct RosBag {
    writer: Sink,
    channels: [u16; TOPICS.len()],
    /// Only this episode, or all.
    only: Option<u32>,
    odometry: DeadReckoning,
    turns: Turns,
    /// Messages that are to be put in the order of time: when, topic and bytes.
    waiting: Vec<(u64, Topic, Vec<u8>)>,
    /// When the last message was written.
    now_ns: u64,
    is_begun: bool,
    fault: Option<McapError>,
}

impl RosBag {
    /// A bag of one episode, counted from 1, or of all.
    ///
    /// # Errors
    /// When the head cannot be encoded.
    pub fn new(only: Option<u32>, robot: RosRobot) -> Result<Self, RecordError> {
        let (writer, channels) = begun().map_err(unwritten)?;
        Ok(Self {
            writer,
            channels,
            only,
            odometry: DeadReckoning::new(robot.wheel_base_m),
            turns: Turns::new(robot.lidar, robot.range_max_m),
            waiting: Vec::new(),
            now_ns: 0,
            is_begun: false,
            fault: None,
        })
    }

    /// The whole file.
    ///
    /// # Errors
    /// The first fault on the way.
    pub fn finish(mut self) -> Result<Vec<u8>, RecordError> {
        if let Some(fault) = self.fault {
            return Err(unwritten(fault));
        }
        self.writer.finish().map_err(unwritten)?;
        Ok(self.writer.into_inner().into_inner())
    }

    fn wants(&self, episode: u32) -> bool {
        self.fault.is_none() && self.only.is_none_or(|only| only == episode)
    }

    fn tell(&mut self, topic: Topic, time_ns: u64, message: &impl Serialize) {
        let body = cdr_encoding::to_vec::<_, LittleEndian>(message)
            .expect("the messages hold nothing that the encoding lacks");
        let message = [&ENCAPSULATION[..], &body].concat();
        self.waiting.push((time_ns, topic, message));
    }

    /// Writes what waits, in the order of time.
    fn write(&mut self) -> McapResult<()> {
        self.waiting.sort_by_key(|(time_ns, ..)| *time_ns);
        for (time_ns, topic, message) in self.waiting.drain(..) {
            self.now_ns = self.now_ns.max(time_ns);
            let header = MessageHeader {
                channel_id: self.channels[topic as usize],
                sequence: 0,
                log_time: time_ns,
                publish_time: time_ns,
            };
            self.writer.write_to_known_channel(&header, &message)?;
        }
        Ok(())
    }

    /// What never changes: the walls, and where the lidar is on the robot.
    fn introduce(&mut self, view: &View<'_>) {
        let time_ns = view.trace.first().map_or(0, |sample| sample.time_ns);
        let mount = Transforms::new(time_ns, &[(BASE, LASER, Isometry2::identity())]);
        self.tell(Topic::TfStatic, time_ns, &mount);
        self.tell(Topic::Map, time_ns, &OccupancyGrid::new(time_ns, view.maze));
    }

    /// What happened in a view, from the moment `first` of its path.
    fn follow(&mut self, view: &View<'_>, first: usize) {
        for beam in view.sensed.iter().flat_map(|sensed| sensed.beams) {
            if let Some(scan) = self.turns.beam(beam) {
                self.tell(Topic::Scan, beam.time_ns, &scan);
            }
        }
        for (at, sample) in view.trace.iter().enumerate().skip(first) {
            let estimate = view.sensed.and_then(|sensed| sensed.estimates.get(at));
            self.moment(sample, estimate);
        }
    }

    fn moment(&mut self, sample: &Sample, estimate: Option<&Estimate>) {
        let (time_ns, truth) = (sample.time_ns, sample.robot_in_map);
        let motion = self.odometry.step(sample);
        let in_map = estimate.map_or(truth, |estimate| estimate.robot_in_map);
        let correction = in_map * motion.pose.inverse();
        let frames = [(MAP, ODOM, correction), (ODOM, BASE, motion.pose)];
        self.tell(Topic::Tf, time_ns, &Transforms::new(time_ns, &frames));
        let moved = (&motion.moved, motion.since_s);
        let odometry = Odometry::new(time_ns, [ODOM, BASE], &motion.pose, moved);
        self.tell(Topic::Odom, time_ns, &odometry);
        if let Some(Estimate { covariance, .. }) = estimate {
            let pose = EstimatedPose::new(time_ns, &in_map, covariance);
            self.tell(Topic::Pose, time_ns, &pose);
        }
        let moved = (&motion.truly_moved, motion.since_s);
        let truth = Odometry::new(time_ns, [MAP, TRUE_BASE], &truth, moved);
        self.tell(Topic::GroundTruth, time_ns, &truth);
    }
}

impl Observer for RosBag {
    fn began(&mut self, episode: u32, view: &View<'_>) {
        if !self.wants(episode) {
            return;
        }
        self.odometry.put_down();
        if !self.is_begun {
            self.introduce(view);
            self.is_begun = true;
        }
        self.follow(view, 0);
        self.fault = self.write().err();
    }

    fn stepped(&mut self, step: &Step<'_>) {
        if self.wants(step.episode) {
            // The path of a move begins where the last one ended.
            self.follow(&step.view, 1);
            self.fault = self.write().err();
        }
    }

    fn ended(&mut self, episode: &Episode, _: &Learned<'_>) -> ControlFlow<()> {
        // The lidar turns on while the robot is put somewhere else: that is another turn.
        if let Some(scan) = self.turns.end()
            && self.fault.is_none()
        {
            self.tell(Topic::Scan, self.now_ns, &scan);
            self.fault = self.write().err();
        }
        match self.fault.is_some() || self.only == Some(episode.episode) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }
}
