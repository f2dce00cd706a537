//! Recordings of drives: sensor readings, commands and decisions.

use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use byteorder::LittleEndian;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::drive_messages::{Clock, Imu, JointState, Text, Twist};
use super::messages::{EstimatedPose, LaserScan, MAP, ODOM, OccupancyGrid, Odometry, Transforms};
use super::topics::BagTopic;
use super::writer::{ENCAPSULATION, RosWriter, encoded};
use crate::Error;
use crate::disk;
use crate::drive::{DriverStep, Fault, Readings};
use crate::record::{fault, records};
use crate::world::Maze;

/// The topics of the file.
const TOPICS: [BagTopic; 13] = [
    BagTopic::Scan,
    BagTopic::Odom,
    BagTopic::Imu,
    BagTopic::JointStates,
    BagTopic::InitialPose,
    BagTopic::Clock,
    BagTopic::CmdVel,
    BagTopic::Tf,
    BagTopic::TfStatic,
    BagTopic::Pose,
    BagTopic::Map,
    BagTopic::Decision,
    BagTopic::Fault,
];

/// Writes the recording of a drive, message by message.
///
/// Readings that arrived between two steps of the driver get the time of the later step, so that
/// the drive can be repeated.
pub struct DriveBag {
    path: PathBuf,
    part: PathBuf,
    replace: bool,
    writer: RosWriter<BufWriter<File>>,
    /// The names of the faults in the last fault message.
    faults: Vec<&'static str>,
    clock_ns: Option<u64>,
}

impl DriveBag {
    /// Starts a recording, with the walls of the maze. It is called `path.part` until it is finished;
    /// until then, an earlier file is left as it is.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written, or exists and must not be replaced.
    pub fn create(path: &Path, replace: bool, maze: &Maze, time_ns: u64) -> Result<Self, Error> {
        let part = disk::part(path);
        let file = disk::require_free(path, replace)
            .and_then(|()| disk::create(&part))
            .map_err(disk::cannot_create(path))?;
        let file = BufWriter::new(file);
        let mut bag = Self {
            path: path.to_owned(),
            part,
            replace,
            writer: RosWriter::begin(file, &TOPICS).map_err(fault::cannot_write(path))?,
            faults: Vec::new(),
            clock_ns: None,
        };
        bag.write(BagTopic::Map, time_ns, &OccupancyGrid::new(time_ns, maze))?;
        Ok(bag)
    }

    /// Writes the readings that arrived until a step of the driver, and the result of the step.
    ///
    /// # Errors
    /// Returns an error if the disk is full or fails.
    pub fn step(
        &mut self,
        time_ns: u64,
        readings: &Readings,
        step: &DriverStep,
    ) -> Result<(), Error> {
        if let Some(clock_ns) = readings
            .clock_ns
            .filter(|_| self.clock_ns != readings.clock_ns)
        {
            self.clock_ns = readings.clock_ns;
            self.write(BagTopic::Clock, time_ns, &Clock::new(clock_ns))?;
        }
        if !readings.static_transforms.is_empty() {
            let transforms = Transforms::from(&readings.static_transforms[..]);
            self.write(BagTopic::TfStatic, time_ns, &transforms)?;
        }
        for odometry in &readings.odometry {
            self.write(BagTopic::Odom, time_ns, &Odometry::from(odometry))?;
        }
        if !readings.transforms.is_empty() {
            let transforms = Transforms::from(&readings.transforms[..]);
            self.write(BagTopic::Tf, time_ns, &transforms)?;
        }
        for joints in &readings.joints {
            self.write(BagTopic::JointStates, time_ns, &JointState::from(joints))?;
        }
        for pose in &readings.initial_poses {
            self.write(BagTopic::InitialPose, time_ns, &EstimatedPose::from(pose))?;
        }
        for imu in &readings.imu {
            self.write(BagTopic::Imu, time_ns, &Imu::from(imu))?;
        }
        for scan in &readings.scans {
            self.write(BagTopic::Scan, time_ns, &LaserScan::from(scan))?;
        }
        self.write(BagTopic::CmdVel, time_ns, &Twist::from(step.command))?;
        if let Some(belief) = &step.belief {
            if belief.is_own {
                let frames = [(MAP, ODOM, belief.odom_in_map)];
                let transforms = Transforms::new(belief.stamp_ns, &frames);
                self.write(BagTopic::Tf, time_ns, &transforms)?;
            }
            self.write(BagTopic::Pose, time_ns, &EstimatedPose::from(belief))?;
        }
        if let Some(decision) = &step.decision {
            self.write(
                BagTopic::Decision,
                time_ns,
                &Text::new(decision.words.clone()),
            )?;
        }
        let faults: Vec<_> = step.faults.iter().map(Fault::name).collect();
        if faults != self.faults {
            self.faults = faults;
            let words: Vec<String> = step.faults.iter().map(Fault::to_string).collect();
            self.write(BagTopic::Fault, time_ns, &Text::new(words.join("; ")))?;
        }
        Ok(())
    }

    fn write(
        &mut self,
        topic: BagTopic,
        time_ns: u64,
        message: &impl Serialize,
    ) -> Result<(), Error> {
        let message = encoded(message).map_err(|cause| fault::write_failed(&self.path, cause))?;
        let written = self.writer.write(topic, time_ns, &message);
        written.map_err(fault::cannot_write(&self.path))
    }

    /// Finishes the recording, and gives it its name.
    ///
    /// # Errors
    /// Returns an error if the disk is full or fails.
    pub fn finish(self) -> Result<(), Error> {
        let saved = self.writer.finish().and_then(|file| {
            let file = file.into_inner().map_err(|e| e.into_error())?;
            file.sync_all()?;
            disk::require_free(&self.path, self.replace)?;
            Ok(fs::rename(&self.part, &self.path)?)
        });
        saved.map_err(fault::cannot_write(&self.path))
    }
}

/// The contents of a recorded drive, or of a bag from another program.
#[derive(Debug, Clone, Default)]
pub struct DriveRecording {
    /// The readings, by the time when they were recorded, in nanoseconds.
    pub readings: Vec<(u64, Readings)>,
    /// The decisions of the driver as text; empty in bags from other programs.
    pub decisions: Vec<String>,
}

/// The memory that a message takes beside its data: an entry for the time of its arrival.
const KEPT_BYTES_A_MESSAGE: usize = 1024;

/// Returns the limit on the memory for the messages of a bag of `size` bytes.
fn most_kept(size: usize) -> usize {
    size.saturating_mul(32).saturating_add(64 << 20)
}

impl DriveRecording {
    /// Reads `/scan`, `/odom`, `/imu`, `/joint_states`, `/initialpose`, `/tf`, `/tf_static`, `/clock` and
    /// `/cmd_vel`, in any namespace, from an MCAP file in the encoding of ROS 2.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, is damaged, or has other message types under
    /// these names.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let bytes = disk::read(path, disk::MOST_BYTES).map_err(disk::cannot_read(path))?;
        if !bytes.starts_with(mcap::MAGIC) {
            return Err(fault::not_a_recording(path, &bytes));
        }
        let damaged = fault::damaged::<String>(path);
        records::check_unpacked(&bytes).map_err(&damaged)?;
        let mut recording = Self::default();
        let mut clock_ns = None;
        let most = most_kept(bytes.len());
        let mut kept = 0;
        for message in records::messages(&bytes) {
            let message = message.map_err(|cause| damaged(cause.to_string()))?;
            let channel = &message.channel;
            // The true pose is an odometry message, too, but no reading.
            if channel.topic.contains("/ground_truth/") {
                continue;
            }
            let topic = channel.topic.rsplit('/').next().unwrap_or_default();
            if TOPICS.iter().any(|known| known.name().ends_with(topic)) {
                kept += KEPT_BYTES_A_MESSAGE + 2 * message.data.len();
            }
            if kept > most {
                return Err(damaged(format!(
                    "its messages would take more than {most} bytes, the most for a bag of its size; \
                     record fewer topics, such as without /clock"
                )));
            }
            let added = recording.add(topic, message.log_time, &message.data, &mut clock_ns);
            added.map_err(|cause| damaged(format!("{}: {cause}", channel.topic)))?;
        }
        Ok(recording)
    }

    fn add(
        &mut self,
        topic: &str,
        time_ns: u64,
        data: &[u8],
        clock_ns: &mut Option<u64>,
    ) -> Result<(), String> {
        match topic {
            "scan" => {
                let scan = decoded::<LaserScan>(data)?;
                self.at(time_ns, *clock_ns).scans.push((&scan).into());
            }
            "odom" => {
                let odometry = decoded::<Odometry>(data)?;
                self.at(time_ns, *clock_ns)
                    .odometry
                    .push((&odometry).into());
            }
            "tf" => {
                let transforms = decoded::<Transforms>(data)?;
                let all = &mut self.at(time_ns, *clock_ns).transforms;
                all.extend(transforms.transforms.iter().map(Into::into));
            }
            "joint_states" => {
                let joints = decoded::<JointState>(data)?;
                self.at(time_ns, *clock_ns).joints.push((&joints).into());
            }
            "initialpose" => {
                let pose = decoded::<EstimatedPose>(data)?;
                let all = &mut self.at(time_ns, *clock_ns).initial_poses;
                all.push((&pose).into());
            }
            "tf_static" => {
                let transforms = decoded::<Transforms>(data)?;
                let all = &mut self.at(time_ns, *clock_ns).static_transforms;
                all.extend(transforms.transforms.iter().map(Into::into));
            }
            "imu" => {
                let imu = decoded::<Imu>(data)?;
                self.at(time_ns, *clock_ns).imu.push((&imu).into());
            }
            "clock" => {
                *clock_ns = Some(decoded::<Clock>(data)?.clock.nanoseconds());
                self.at(time_ns, *clock_ns);
            }
            // Add an entry for the call of the driver, even if no readings arrived.
            "cmd_vel" => {
                self.at(time_ns, *clock_ns);
            }
            "decision" => self
                .decisions
                .push(decoded::<Text>(data)?.data.into_owned()),
            _ => {}
        }
        Ok(())
    }

    /// Returns the readings at a time.
    fn at(&mut self, time_ns: u64, clock_ns: Option<u64>) -> &mut Readings {
        if self
            .readings
            .last()
            .is_none_or(|(last_ns, _)| *last_ns != time_ns)
        {
            self.readings.push((time_ns, Readings::default()));
        }
        let last = self.readings.len() - 1;
        let readings = &mut self.readings[last].1;
        readings.clock_ns = clock_ns;
        readings
    }
}

/// Decodes a message with its four-byte encapsulation header.
fn decoded<M: DeserializeOwned>(data: &[u8]) -> Result<M, String> {
    match data.split_at_checked(ENCAPSULATION.len()) {
        Some((head, body)) if head[..2] == ENCAPSULATION[..2] => {
            let decoded = cdr_encoding::from_bytes::<M, LittleEndian>(body);
            decoded
                .map(|(message, _)| message)
                .map_err(|e| e.to_string())
        }
        _ => Err("not in the little-endian encoding of ROS 2".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bag_in_another_format_is_refused_with_what_to_do_and_nothing_is_replaced_unasked() {
        let folder = tempfile::tempdir().unwrap();
        let refused = |bytes: &[u8]| {
            let path = folder.path().join("bag");
            std::fs::write(&path, bytes).unwrap();
            DriveRecording::read(&path).unwrap_err().to_string()
        };
        let database = refused(b"SQLite format 3\0");
        assert!(database.contains("`ros2 bag convert`"), "{database}");
        let text = refused(b"A text.");
        assert!(text.contains("does not begin like an MCAP file"), "{text}");
        let damaged = refused(mcap::MAGIC);
        assert!(damaged.contains("is damaged"), "control: {damaged}");
        // An attachment that is shorter than its length fields say.
        let attachment = [&[mcap::records::op::ATTACHMENT, 35][..], &[0; 7 + 35]].concat();
        let damaged = refused(&[mcap::MAGIC, &attachment].concat());
        assert!(damaged.contains("is damaged"), "{damaged}");

        let rows = br######"{ "rows": ["####", "#SG#", "####"] }"######;
        let maze = Maze::from_json(rows, "rows").unwrap();
        let create = |replace| DriveBag::create(&folder.path().join("bag"), replace, &maze, 0);
        let kept = create(false).err().expect("the file exists").to_string();
        assert!(kept.contains("`--force`"), "{kept}");
        assert!(create(true).is_ok(), "control");
    }
    #[test]
    fn a_bag_that_unpacks_to_much_is_refused_before_it_is_unpacked() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bomb");
        let mut writer = RosWriter::begin(File::create(&path).unwrap(), &[BagTopic::Scan]).unwrap();
        let zeros = vec![0; 1 << 20];
        for time_ns in 0..64 {
            writer.write(BagTopic::Scan, time_ns, &zeros).unwrap();
        }
        writer.finish().unwrap();
        assert!(path.metadata().unwrap().len() < 100_000);
        let fault = DriveRecording::read(&path).unwrap_err().to_string();
        assert!(fault.contains("unpack to"), "{fault}");
    }

    #[test]
    fn an_unfinished_bag_leaves_an_earlier_one_as_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bag");
        let earlier = || std::fs::read(&path).unwrap() == b"mine";
        std::fs::write(&path, "mine").unwrap();
        let rows = br######"{ "rows": ["####", "#SG#", "####"] }"######;
        let maze = Maze::from_json(rows, "rows").unwrap();
        drop(DriveBag::create(&path, true, &maze, 0).unwrap());
        assert!(earlier(), "replaced before it was finished");
        let bag = DriveBag::create(&path, true, &maze, 0).unwrap();
        bag.finish().unwrap();
        assert!(!earlier(), "control");
    }
}
