//! Poses from outside: of another localiser, and of the operator.

use nalgebra::Isometry2;

use super::bag::messages::MAP;
use super::checks::without_slash;
use super::fault::Fault;
use super::mounting::on_floor;
use super::readings::{Readings, Transform};
use super::setup::{DriveSetup, start};

const SECOND_NS: f64 = 1e9;
/// The longest time without a pose of the localiser, in nanoseconds.
const AGE_NS: u64 = 1_000_000_000;
/// A change of the pose from one message to the next by more than this is a jump: in metres, and in
/// radians.
const JUMP: [f64; 2] = [0.5, 0.5];

/// Where the pose of the robot comes from.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum PoseSource {
    /// The filter of the drive.
    #[default]
    Own,
    /// The transform from `map` to `odom` on `/tf`, of another localiser.
    Tf,
}

/// Takes in poses from outside.
#[derive(Debug)]
pub struct Given {
    source: PoseSource,
    odom: String,
    begun_ns: Option<u64>,
    /// The last transform, with the time of its arrival.
    last: Option<(u64, Isometry2<f64>)>,
    transform_fault: Option<Fault>,
    start_fault: Option<Fault>,
}

/// The result of a step.
#[derive(Debug, Default)]
pub struct Taken {
    /// The robot must rest and begin again, because its pose has changed.
    pub begins_again: bool,
    /// The new start pose in the grid frame.
    pub start_in_grid: Option<Isometry2<f64>>,
    pub faults: Vec<Fault>,
}

impl Given {
    /// Creates a receiver for a drive.
    pub fn new(setup: &DriveSetup) -> Self {
        Self {
            source: setup.source,
            odom: setup.frames.odom.clone(),
            begun_ns: None,
            last: None,
            transform_fault: None,
            start_fault: None,
        }
    }

    /// Returns the pose of the odometry frame in the map, by the other localiser.
    pub fn odom_in_map(&self) -> Option<Isometry2<f64>> {
        self.last.map(|(_, pose)| pose)
    }

    /// Takes in the poses that arrived until `steady_ns`, a clock that never jumps.
    pub fn step(&mut self, steady_ns: u64, readings: &Readings, setup: &DriveSetup) -> Taken {
        let mut taken = Taken::default();
        match self.source {
            PoseSource::Own => self.take_starts(readings, setup, &mut taken),
            PoseSource::Tf => self.take_transforms(steady_ns, readings, &mut taken),
        }
        taken
    }

    fn take_starts(&mut self, readings: &Readings, setup: &DriveSetup, taken: &mut Taken) {
        for given in &readings.initial_poses {
            let found = start_of(given, setup);
            self.start_fault = found.as_ref().err().cloned();
            if let Ok(pose) = found {
                (taken.begins_again, taken.start_in_grid) = (true, Some(pose));
            }
        }
        taken.faults.extend(self.start_fault.clone());
    }

    fn take_transforms(&mut self, steady_ns: u64, readings: &Readings, taken: &mut Taken) {
        let begun_ns = *self.begun_ns.get_or_insert(steady_ns);
        let is_ours = |transform: &&Transform| {
            let [parent, child] = [&transform.parent, &transform.child].map(|it| without_slash(it));
            parent == MAP && child == self.odom
        };
        let ours: Vec<_> = readings.transforms.iter().filter(is_ours).collect();
        for transform in ours {
            self.transform_fault = None;
            if !transform.is_valid() {
                self.transform_fault = Some(Fault::InvalidLocalisation);
                continue;
            }
            let pose = on_floor(&transform.pose);
            if let Some((_, last)) = self.last {
                let moved = last.inverse() * pose;
                let (by_m, by_rad) = (moved.translation.vector.norm(), moved.rotation.angle());
                if by_m > JUMP[0] || by_rad.abs() > JUMP[1] {
                    self.transform_fault = Some(Fault::LocalisationJumped { by_m, by_rad });
                    taken.begins_again = true;
                }
            }
            self.last = Some((steady_ns, pose));
        }
        let since_ns = self.last.map_or(begun_ns, |(arrived_ns, _)| arrived_ns);
        let age_ns = steady_ns.saturating_sub(since_ns);
        if self.last.is_none() || age_ns > AGE_NS {
            taken
                .faults
                .push(Fault::NoLocalisation(age_ns as f64 / SECOND_NS));
        }
        taken.faults.extend(self.transform_fault.clone());
    }
}

/// Returns the start pose in the grid frame of a pose of the operator.
fn start_of(given: &Transform, setup: &DriveSetup) -> Result<Isometry2<f64>, Fault> {
    let frame = without_slash(&given.parent);
    if frame != MAP {
        return Err(Fault::InvalidStart(format!("is in the frame `{frame}`")));
    }
    let not_numbers = || Fault::InvalidStart("is not of numbers".to_owned());
    let pose = Some(on_floor(&given.pose)).filter(|_| given.is_valid());
    let pose = pose.ok_or_else(not_numbers)?;
    let at = [
        pose.translation.x,
        pose.translation.y,
        pose.rotation.angle(),
    ];
    start(&setup.maze, Some(at)).map_err(|_| {
        let [x, y, _] = at;
        Fault::InvalidStart(format!("is not in a free cell: {x:.2},{y:.2} m"))
    })
}
