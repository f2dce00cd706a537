//! Recordings for ROS 2: CDR messages for `ros2 bag` and rviz.
//!
//! The frames are those of a real robot (REP 105): `map`, `odom` and `base_link`. The true pose,
//! which the robot does not know, is published on `/ground_truth/odom` only.

mod dead_reckoning;
mod drive_bag;
pub mod drive_messages;
pub mod messages;
mod topics;
mod turn;
mod writer;

use std::io::Cursor;
use std::ops::ControlFlow;
use std::path::Path;

use mcap::{McapError, McapResult};
use nalgebra::Isometry2;
use serde::Serialize;

use crate::arena::{Estimate, LidarParams, Sample, View};
use crate::episode::{Episode, Learned, Observer, Step};
use crate::error::Error;
use crate::record::error;
use dead_reckoning::DeadReckoning;
pub use drive_bag::{DriveBag, DriveRecording};
use messages::{
    BASE, EstimatedPose, LASER, LaserScan, MAP, ODOM, OccupancyGrid, Odometry, TRUE_BASE,
    Transforms,
};
use topics::Topic;
use turn::Turns;
use writer::{RosWriter, encoded};

/// The topics of the file.
const TOPICS: [Topic; 7] = [
    Topic::Tf,
    Topic::TfStatic,
    Topic::Odom,
    Topic::Pose,
    Topic::Scan,
    Topic::Map,
    Topic::GroundTruth,
];

fn write_error(cause: McapError) -> Error {
    error::write(Path::new("the recording for ROS 2"))(cause)
}

/// Observes episodes and writes the messages that a ROS 2 robot would have recorded.
pub struct RosBag {
    writer: RosWriter<Cursor<Vec<u8>>>,
    /// The number of the only episode to record; `None` records all.
    only: Option<u32>,
    odometry: DeadReckoning,
    turns: Turns,
    /// Buffered messages, to be sorted by time: time, topic and bytes.
    pending: Vec<(u64, Topic, Vec<u8>)>,
    /// The time of the last message written.
    now_ns: u64,
    is_begun: bool,
    fault: Option<McapError>,
}

impl RosBag {
    /// Creates a bag of one episode, counted from 1, or of all episodes. `wheel_base_m` is the
    /// distance between the robot's wheels in metres; `None` for a robot without wheels.
    ///
    /// # Errors
    /// If the file's header cannot be encoded.
    pub fn new(
        only: Option<u32>,
        wheel_base_m: Option<f64>,
        lidar: LidarParams,
    ) -> Result<Self, Error> {
        let writer = RosWriter::begin(Cursor::new(Vec::new()), &TOPICS);
        Ok(Self {
            writer: writer.map_err(write_error)?,
            only,
            odometry: DeadReckoning::new(wheel_base_m),
            turns: Turns::new(lidar),
            pending: Vec::new(),
            now_ns: 0,
            is_begun: false,
            fault: None,
        })
    }

    /// Finishes the file and returns its bytes.
    ///
    /// # Errors
    /// The first error that occurred while writing.
    pub fn finish(self) -> Result<Vec<u8>, Error> {
        if let Some(fault) = self.fault {
            return Err(write_error(fault));
        }
        let out = self.writer.finish().map_err(write_error)?;
        Ok(out.into_inner())
    }

    fn wants(&self, episode: u32) -> bool {
        self.fault.is_none() && self.only.is_none_or(|only| only == episode)
    }

    fn queue(&mut self, topic: Topic, time_ns: u64, message: &impl Serialize) {
        let message = encoded(message).expect("the messages hold nothing that the encoding lacks");
        self.pending.push((time_ns, topic, message));
    }

    /// Writes the buffered messages in order of time.
    fn write(&mut self) -> McapResult<()> {
        self.pending.sort_by_key(|(time_ns, ..)| *time_ns);
        for (time_ns, topic, message) in self.pending.drain(..) {
            self.now_ns = self.now_ns.max(time_ns);
            self.writer.write(topic, time_ns, &message)?;
        }
        Ok(())
    }

    /// Writes the static messages: the walls, and the lidar's pose on the robot.
    fn queue_static(&mut self, view: &View<'_>) {
        let time_ns = view.trace.first().map_or(0, |sample| sample.time_ns);
        let mount = Transforms::new(time_ns, &[(BASE, LASER, Isometry2::identity())]);
        self.queue(Topic::TfStatic, time_ns, &mount);
        self.queue(Topic::Map, time_ns, &OccupancyGrid::new(time_ns, view.maze));
    }

    /// Adds the messages of a view, from sample `first` of its trace on.
    fn follow(&mut self, view: &View<'_>, first: usize) {
        for beam in view.sensed.iter().flat_map(|sensed| sensed.beams) {
            if let Some(scan) = self.turns.beam(beam) {
                self.queue(Topic::Scan, beam.time_ns, &LaserScan::from(&scan));
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
        self.queue(Topic::Tf, time_ns, &Transforms::new(time_ns, &frames));
        let moved = (&motion.moved, motion.since_s);
        let odometry = Odometry::new(time_ns, [ODOM, BASE], &motion.pose, moved);
        self.queue(Topic::Odom, time_ns, &odometry);
        if let Some(Estimate { covariance, .. }) = estimate {
            let pose = EstimatedPose::new(time_ns, &in_map, covariance);
            self.queue(Topic::Pose, time_ns, &pose);
        }
        let moved = (&motion.truly_moved, motion.since_s);
        let truth = Odometry::new(time_ns, [MAP, TRUE_BASE], &truth, moved);
        self.queue(Topic::GroundTruth, time_ns, &truth);
    }
}

impl Observer for RosBag {
    fn began(&mut self, episode: u32, view: &View<'_>) {
        if !self.wants(episode) {
            return;
        }
        self.odometry.put_down();
        if !self.is_begun {
            self.queue_static(view);
            self.is_begun = true;
        }
        self.follow(view, 0);
        self.fault = self.write().err();
    }

    fn stepped(&mut self, step: &Step<'_>) {
        if self.wants(step.episode) {
            // The first sample of a move is the last sample of the previous one.
            self.follow(&step.view, 1);
            self.fault = self.write().err();
        }
    }

    fn ended(&mut self, episode: &Episode, _: &Learned<'_>) -> ControlFlow<()> {
        // The lidar keeps turning while the robot is placed somewhere else; a new turn begins
        // there.
        if let Some(scan) = self.turns.end()
            && self.fault.is_none()
        {
            self.queue(Topic::Scan, self.now_ns, &LaserScan::from(&scan));
            self.fault = self.write().err();
        }
        match self.fault.is_some() || self.only == Some(episode.episode) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }
}
