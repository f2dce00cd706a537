//! Recordings for ROS 2: messages in its own encoding, for `ros2 bag` and rviz.
//!
//! The frames are those of a real robot: `map`, and `base_link` where the robot believes to be. A
//! robot that senses also has `base_link_true`, which no robot could know.

mod messages;
mod schemas;

use std::collections::BTreeMap;
use std::io::Cursor;
use std::ops::ControlFlow;

use byteorder::LittleEndian;
use mcap::records::MessageHeader;
use mcap::{Compression, McapError, McapResult, WriteOptions, Writer};
use nalgebra::{Isometry2, Matrix3};
use serde::Serialize;

use crate::arena::{Sample, View};
use crate::episode::{Episode, Learned, Observer, Step};
use crate::record::error::RecordError;
use crate::record::topics::scan::scans;
use messages::{LaserScan, OccupancyGrid, Odometry, Transforms};
use schemas::{GRID, Interface, ODOMETRY, SCAN, TRANSFORMS};

/// What precedes a message: its byte order, little-endian, and no options.
const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];
const LIBRARY: &str = concat!("xcscr/", env!("CARGO_PKG_VERSION"));

/// The topics, by the number of their channel.
const TOPICS: [(&str, Interface); 4] = [
    ("/tf", TRANSFORMS),
    ("/odom", ODOMETRY),
    ("/scan", SCAN),
    ("/map", GRID),
];
const TF: usize = 0;
const ODOM: usize = 1;
const SCANS: usize = 2;
const MAP: usize = 3;

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
    for (channel, (topic, Interface { name, definition })) in channels.iter_mut().zip(TOPICS) {
        let schema = writer.add_schema(name, "ros2msg", definition.as_bytes())?;
        *channel = writer.add_channel(schema, topic, "cdr", &BTreeMap::new())?;
    }
    Ok((writer, channels))
}

fn unwritten(cause: McapError) -> RecordError {
    RecordError::Write {
        path: "the recording for ROS 2".into(),
        cause: cause.to_string(),
    }
}

/// Watches episodes and writes what a ROS 2 robot would have recorded.
pub struct RosBag {
    writer: Sink,
    channels: [u16; TOPICS.len()],
    /// Only this episode, or all.
    only: Option<u32>,
    /// As far as the lidar sees, in metres.
    range_max_m: f64,
    /// The last pose that was written, and when.
    last: Option<(u64, Isometry2<f64>)>,
    fault: Option<McapError>,
}

impl RosBag {
    /// A bag of one episode, counted from 1, or of all.
    ///
    /// # Errors
    /// When the head cannot be encoded.
    pub fn new(only: Option<u32>, range_max_m: f64) -> Result<Self, RecordError> {
        let (writer, channels) = begun().map_err(unwritten)?;
        Ok(Self {
            writer,
            channels,
            only,
            range_max_m,
            last: None,
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

    fn send(&mut self, topic: usize, time_ns: u64, message: &impl Serialize) -> McapResult<()> {
        let body = cdr_encoding::to_vec::<_, LittleEndian>(message)
            .expect("the messages hold nothing that the encoding lacks");
        let header = MessageHeader {
            channel_id: self.channels[topic],
            sequence: 0,
            log_time: time_ns,
            publish_time: time_ns,
        };
        let message = [&ENCAPSULATION[..], &body].concat();
        self.writer.write_to_known_channel(&header, &message)
    }

    /// What happened in a view, from the moment `first` of its path.
    fn tell(&mut self, view: &View<'_>, first: usize) -> McapResult<()> {
        for (time_ns, scan) in scans(view, first == 0) {
            let scan = LaserScan::new(time_ns, &scan, self.range_max_m);
            self.send(SCANS, time_ns, &scan)?;
        }
        for (at, sample) in view.trace.iter().enumerate().skip(first) {
            let estimate = view.sensed.and_then(|sensed| sensed.estimates.get(at));
            let belief = estimate.map(|e| (e.robot_in_world, e.covariance));
            self.pose(sample, belief)?;
        }
        Ok(())
    }

    fn pose(
        &mut self,
        sample: &Sample,
        belief: Option<(Isometry2<f64>, Matrix3<f64>)>,
    ) -> McapResult<()> {
        let (time_ns, truth) = (sample.time_ns, sample.robot_in_world);
        let believed = belief.map(|(pose, _)| pose);
        let transforms = Transforms::new(time_ns, &truth, believed.as_ref());
        self.send(TF, time_ns, &transforms)?;
        let (pose, covariance) = belief.unwrap_or((truth, Matrix3::zeros()));
        let (before_ns, before) = self
            .last
            .replace((time_ns, pose))
            .unwrap_or((time_ns, pose));
        let since_s = time_ns.saturating_sub(before_ns) as f64 * 1e-9;
        let odometry = Odometry::new(time_ns, &pose, &covariance, (&before, since_s));
        self.send(ODOM, time_ns, &odometry)
    }
}

impl Observer for RosBag {
    fn began(&mut self, episode: u32, view: &View<'_>) {
        if !self.wants(episode) {
            return;
        }
        // The robot was put somewhere: that is no motion.
        self.last = None;
        let time_ns = view.trace.first().map_or(0, |sample| sample.time_ns);
        let map = OccupancyGrid::new(time_ns, view.maze);
        let told = self.send(MAP, time_ns, &map);
        self.fault = told.and_then(|()| self.tell(view, 0)).err();
    }

    fn stepped(&mut self, step: &Step<'_>) {
        if self.wants(step.episode) {
            // The path of a move begins where the last one ended.
            self.fault = self.tell(&step.view, 1).err();
        }
    }

    fn ended(&mut self, episode: &Episode, _: &Learned<'_>) -> ControlFlow<()> {
        match self.fault.is_some() || self.only == Some(episode.episode) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }
}
