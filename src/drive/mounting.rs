//! Where the lidar is on the robot, by the static transforms.

use std::collections::BTreeMap;

use nalgebra::{Isometry2, Isometry3, Vector2, Vector3};

use super::checks::{Frames, without_slash};
use super::fault::Fault;
use super::readings::{Scan, Transform};

/// The longest chain of frames from the lidar to the robot.
const LONGEST_CHAIN: usize = 32;
/// The least cosine of the angle between the lidar's axis and the vertical: 10 degrees.
const UPRIGHT: f64 = 0.985;

/// A scan and the pose of its lidar on the robot.
#[derive(Debug)]
pub struct MountedScan {
    pub scan: Scan,
    pub laser_in_base: Isometry2<f64>,
}

/// The poses of lidars.
#[derive(Debug)]
pub struct Mounting {
    /// The pose that was given; `None` if the static transforms have it.
    given: Option<Isometry2<f64>>,
    frames: Frames,
    /// Frames by name: the parent, and the pose in it.
    parents: BTreeMap<String, (String, Isometry3<f64>)>,
}

impl Mounting {
    /// Creates a mounting with a given pose of the lidar, or without one.
    pub fn new(given: Option<Isometry2<f64>>, frames: Frames) -> Self {
        Self {
            given,
            frames,
            parents: BTreeMap::new(),
        }
    }

    /// Takes in a static transform. One that is not of numbers is ignored, so that a scan in its frame
    /// is a fault.
    pub fn add(&mut self, transform: &Transform) {
        let [parent, child] = [&transform.parent, &transform.child].map(|it| without_slash(it));
        if transform.is_valid() {
            let known = (parent.to_owned(), transform.pose);
            self.parents.insert(child.to_owned(), known);
        }
    }

    /// Returns a scan with the pose of its lidar. The scan of a lidar that hangs upside down is
    /// mirrored.
    ///
    /// # Errors
    /// Returns the fault of a frame without a known pose, or of a tilted lidar.
    pub fn mounted(&self, mut scan: Scan) -> Result<MountedScan, Fault> {
        if let Some(laser_in_base) = self.given {
            return match self.frames.fault_of_scan(&scan.frame) {
                Some(fault) => Err(fault),
                None => Ok(MountedScan {
                    scan,
                    laser_in_base,
                }),
            };
        }
        let frame = without_slash(&scan.frame);
        let pose = self.pose(frame);
        let pose = pose.ok_or_else(|| Fault::NoLaserPose(frame.to_owned()))?;
        let up = (pose.rotation * Vector3::z()).z;
        if up.abs() < UPRIGHT {
            return Err(Fault::TiltedLidar(libm::acos(up).to_degrees()));
        }
        if up < 0.0 {
            scan.angle_min_rad = -scan.angle_min_rad;
            scan.angle_increment_rad = -scan.angle_increment_rad;
        }
        let laser_in_base = on_floor(&pose);
        Ok(MountedScan {
            scan,
            laser_in_base,
        })
    }

    /// Returns the pose of a frame on the robot, along the chain of its parents.
    fn pose(&self, frame: &str) -> Option<Isometry3<f64>> {
        let (mut frame, mut pose) = (frame, Isometry3::identity());
        for _ in 0..LONGEST_CHAIN {
            if self.frames.base.iter().any(|base| base == frame) {
                return Some(pose);
            }
            let (parent, in_parent) = self.parents.get(frame)?;
            (frame, pose) = (parent, in_parent * pose);
        }
        None
    }
}

/// Returns the pose on the floor: the heading of the x axis, and the point below.
pub fn on_floor(pose: &Isometry3<f64>) -> Isometry2<f64> {
    let ahead = pose.rotation * Vector3::x();
    let at = pose.translation.vector;
    Isometry2::new(Vector2::new(at.x, at.y), libm::atan2(ahead.y, ahead.x))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn transform(parent: &str, child: &str, at: [f64; 3], rpy: [f64; 3]) -> Transform {
        let rotation = UnitQuaternion::from_euler_angles(rpy[0], rpy[1], rpy[2]);
        Transform {
            parent: parent.to_owned(),
            child: child.to_owned(),
            pose: Isometry3::from_parts(Vector3::from(at).into(), rotation),
        }
    }

    fn mounted(all: &[Transform]) -> Result<MountedScan, Fault> {
        let mut mounting = Mounting::new(None, Frames::default());
        all.iter().for_each(|transform| mounting.add(transform));
        mounting.mounted(Scan {
            frame: "/rplidar_link".to_owned(),
            angle_min_rad: 0.5,
            angle_increment_rad: 0.1,
            ..Scan::default()
        })
    }

    #[test]
    fn the_pose_of_the_lidar_is_that_of_the_chain_of_static_transforms() {
        let chain = [
            transform("base_link", "shell_link", [0.0, 0.0, 0.09], [0.0; 3]),
            transform(
                "shell_link",
                "rplidar_link",
                [-0.04, 0.0, 0.05],
                [0.0, 0.0, FRAC_PI_2],
            ),
        ];
        let found = mounted(&chain).unwrap();
        let expected = Isometry2::new(Vector2::new(-0.04, 0.0), FRAC_PI_2);
        let off = found.laser_in_base.inverse() * expected;
        assert!(off.translation.vector.norm() < 1e-12 && off.rotation.angle().abs() < 1e-12);
        assert_eq!(found.scan.angle_min_rad, 0.5);
        let name = |all: &[Transform]| mounted(all).unwrap_err().name();
        assert_eq!(name(&chain[1..]), "no-laser-pose", "a link is missing");
        let ring = [
            transform("rplidar_link", "shell_link", [0.0; 3], [0.0; 3]),
            transform("shell_link", "rplidar_link", [0.0; 3], [0.0; 3]),
        ];
        assert_eq!(name(&ring), "no-laser-pose", "a ring");
        let nan = [transform(
            "base_link",
            "rplidar_link",
            [f64::NAN, 0.0, 0.0],
            [0.0; 3],
        )];
        assert_eq!(name(&nan), "no-laser-pose");
    }

    #[test]
    fn a_lidar_upside_down_is_mirrored_and_a_tilted_one_is_refused() {
        let at = |rpy| [transform("base_link", "rplidar_link", [0.0; 3], rpy)];
        let found = mounted(&at([PI, 0.0, 0.0])).unwrap();
        let angles = [found.scan.angle_min_rad, found.scan.angle_increment_rad];
        assert_eq!(angles, [-0.5, -0.1]);
        assert!(found.laser_in_base.rotation.angle().abs() < 1e-12);
        let fault = mounted(&at([0.3, 0.0, 0.0])).unwrap_err();
        assert_eq!(fault.name(), "tilted-lidar");
        assert!(mounted(&at([0.1, 0.0, 0.0])).is_ok(), "control");
    }
}
