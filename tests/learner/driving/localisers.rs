//! Poses from another localiser and from the operator, and wheels by their joints.

use nalgebra::{Isometry2, Isometry3, UnitQuaternion, Vector2, Vector3};

use super::scans::{burger, burger_in, drive_with};
use super::*;
use crate::kit::flat::Flat;

/// The pose of a frame in another one, on the floor.
fn transform(parent: &str, child: &str, pose: Isometry2<f64>) -> Transform {
    let at = pose.translation.vector;
    let turn = UnitQuaternion::from_euler_angles(0.0, 0.0, pose.rotation.angle());
    Transform {
        parent: parent.to_owned(),
        child: child.to_owned(),
        pose: Isometry3::from_parts(Vector3::new(at.x, at.y, 0.0).into(), turn),
    }
}

/// Publishes the transform of a localiser that is off by `error`. `truth` is the pose of the robot in the map.
fn localise(readings: &mut Readings, truth: Isometry2<f64>, error: Isometry2<f64>) {
    let odometry = readings.odometry.last().unwrap();
    let odom_in_map = truth * error * odometry.pose.inverse();
    readings.transforms = vec![
        transform("odom", "base_link", odometry.pose),
        transform("map", "odom", odom_in_map),
    ];
}

fn by_tf() -> DriveOptions {
    DriveOptions {
        source: PoseSource::Tf,
        ..DriveOptions::default()
    }
}

/// Ticks with the pose of a localiser, which the robot has after the tick, and with tampered readings.
fn tick_by_tf(
    rig: &mut Rig,
    error: Isometry2<f64>,
    tamper: impl FnOnce(&mut Readings),
) -> DriverStep {
    let before = rig.robot.true_pose();
    // Odometry moves with the robot, so the transform changes little in a step.
    let odom_before = rig.odom;
    let mut odom = None;
    let step = rig.tick(|readings| {
        odom = readings.odometry.last().map(|odometry| odometry.pose);
        localise(
            readings,
            before * odom_before.inverse() * odom.unwrap(),
            error,
        );
        tamper(readings);
    });
    rig.odom = odom.unwrap();
    step
}

#[test]
fn it_drives_to_the_goal_by_the_poses_of_another_localiser() {
    let maze = Flat::new().gridded(0.5).maze;
    let error = Isometry2::new(Vector2::new(0.03, -0.02), 0.02);
    let mut rig = burger_in(maze, 1, by_tf());
    let mut own = 0;
    let step = (0..12_000)
        .map(|_| {
            let step = tick_by_tf(&mut rig, error, |_| ());
            own += u32::from(step.belief.is_some_and(|belief| belief.is_own));
            step
        })
        .find(|step| step.phase == Phase::AtGoal || step.faults.iter().any(Fault::is_final))
        .unwrap();
    assert_eq!(step.phase, Phase::AtGoal, "{step:?}");
    assert!(rig.robot.is_at_goal());
    assert_eq!(own, 0);
}

#[test]
fn without_valid_poses_of_the_localiser_the_robot_rests() {
    let mut rig = Rig::new(maze4(), 1, by_tf());
    for _ in 0..40 {
        let step = rig.tick(|_| ());
        assert_eq!((step.command, step.phase), (Speeds::REST, Phase::Waiting));
        assert!(
            step.faults
                .iter()
                .any(|fault| fault.name() == "no-localisation")
        );
    }
    let none = Isometry2::identity();
    let nan = |readings: &mut Readings| readings.transforms[1].pose.translation.x = f64::NAN;
    let far = |readings: &mut Readings| readings.transforms[1].pose.translation.x += 3.0;
    let silent = |readings: &mut Readings| readings.transforms.clear();
    let tampers: [(fn(&mut Readings), _, _); 3] = [
        (nan, "invalid-localisation", 1),
        (far, "localisation-jumped", 1),
        (silent, "no-localisation", 21),
    ];
    for (tamper, expected, most) in tampers {
        let mut rig = Rig::new(maze4(), 1, by_tf());
        let moves = (0..200).any(|_| tick_by_tf(&mut rig, none, |_| ()).command.forward_mps > 0.1);
        assert!(moves, "control: {expected}");
        let steps = (1..=most).find(|_| {
            let step = tick_by_tf(&mut rig, none, tamper);
            let names: Vec<_> = step.faults.iter().map(Fault::name).collect();
            assert!(names.is_empty() || names == [expected], "{names:?}");
            !names.is_empty() && step.command == Speeds::REST
        });
        assert_eq!(steps, Some(most), "{expected}");
        let step = (0..4_000)
            .map(|_| tick_by_tf(&mut rig, none, |_| ()))
            .find(|step| step.phase == Phase::AtGoal || step.faults.iter().any(Fault::is_final));
        assert_eq!(step.unwrap().phase, Phase::AtGoal, "control: {expected}");
    }
}

/// Places a Burger beside the pose that the driver is given, and drives. Returns the last step.
fn placed_beside(off: Isometry2<f64>, options: DriveOptions) -> DriverStep {
    let maze = Flat::new().gridded(0.5).maze;
    let mut rig = burger_in(maze.clone(), 1, options);
    let middle = maze.centre_in_grid(maze.start().unwrap());
    rig.robot
        .kidnap(Isometry2::translation(middle.x, middle.y) * off);
    drive(&mut rig).0
}

#[test]
fn a_robot_that_is_placed_roughly_finds_its_pose_with_a_start_tolerance() {
    let off = Isometry2::new(Vector2::new(0.08, -0.06), 0.12);
    let options = DriveOptions {
        start_tolerance: Some([0.1, 0.15]),
        ..DriveOptions::default()
    };
    let step = placed_beside(off, options);
    assert_eq!(step.phase, Phase::AtGoal, "{step:?}");
}

#[test]
fn the_operator_can_give_the_pose() {
    let maze = maze4();
    let cell = Cell { col: 2, row: 6 };
    let at = maze.centre_m(cell);
    let mut rig = Rig::maze4();
    let physics = Plan::new(maze.clone()).config.settings.physics;
    rig.robot = SimulatedRobot::new(maze, &physics, 1, Some([at.x, at.y, FRAC_PI_2])).unwrap();
    let pose = |x: f64, frame: &str| {
        transform(frame, "", Isometry2::new(Vector2::new(x, at.y), FRAC_PI_2))
    };
    let give = |given: Transform| move |readings: &mut Readings| readings.initial_poses.push(given);
    for given in [pose(0.5, "map"), pose(f64::NAN, "map"), pose(at.x, "odom")] {
        let step = rig.tick(give(given));
        assert!(
            step.faults
                .iter()
                .any(|fault| fault.name() == "invalid-start"),
            "{step:?}"
        );
        let step = rig.tick(|_| ());
        assert_eq!(step.command, Speeds::REST, "it waits for another one");
    }
    rig.tick(give(pose(at.x, "map")));
    let (step, decisions, _) = drive(&mut rig);
    assert_eq!(step.phase, Phase::AtGoal, "{step:?}");
    assert_eq!(decisions[0].cell, cell);
}

fn with_wheels() -> DriveOptions {
    DriveOptions {
        wheels: Some(Wheels {
            joints: ["wheel_left_joint", "wheel_right_joint"].map(str::to_owned),
            radius_m: 0.033,
        }),
        ..DriveOptions::default()
    }
}

/// A Burger as its node publishes it: the heading of odometry is that of the IMU, and the joints have the wheels.
struct ByImu {
    last: Isometry2<f64>,
    heading_rad: f64,
    pose: Isometry2<f64>,
    angles_rad: [f64; 2],
}

impl ByImu {
    fn publish(&mut self, readings: &mut Readings) {
        let odometry = readings.odometry.last_mut().unwrap();
        let moved = self.last.inverse() * odometry.pose;
        self.last = odometry.pose;
        let (way_m, turned_rad) = (moved.translation.x, moved.rotation.angle());
        let turn_m = turned_rad * 0.160 / 2.0;
        for (angle_rad, rolled_m) in self
            .angles_rad
            .iter_mut()
            .zip([way_m - turn_m, way_m + turn_m])
        {
            *angle_rad += rolled_m / 0.033;
        }
        self.heading_rad += readings.imu[0].turn_radps * 0.05;
        let turn = Isometry2::rotation(self.heading_rad - self.pose.rotation.angle());
        self.pose *= Isometry2::translation(way_m, 0.0) * turn;
        odometry.pose = self.pose;
        readings.joints.push(JointAngles {
            stamp_ns: odometry.stamp_ns,
            names: ["wheel_left_joint", "wheel_right_joint"]
                .map(str::to_owned)
                .to_vec(),
            angles_rad: self.angles_rad.to_vec(),
        });
    }

    fn new() -> Self {
        Self {
            last: Isometry2::identity(),
            heading_rad: 0.0,
            pose: Isometry2::identity(),
            angles_rad: [2.0, -7.0],
        }
    }
}

#[test]
fn the_wheels_may_come_from_their_joints() {
    let mut rig = burger(1, with_wheels());
    let mut robot = ByImu::new();
    let step = drive_with(&mut rig, |readings| robot.publish(readings));
    assert_eq!(step.phase, Phase::AtGoal, "{step:?}");
}

#[test]
fn impossible_angles_of_the_wheels_stop_the_robot_while_they_last() {
    let tampers: [(fn(&mut JointAngles), _); 4] = [
        (|joints| joints.angles_rad[0] = f64::NAN, "invalid-joints"),
        (|joints| joints.angles_rad[1] += 1e6, "invalid-joints"),
        (
            |joints| joints.names[1] = "arm".to_owned(),
            "invalid-joints",
        ),
        (|joints| joints.stamp_ns += 5_000_000_000, "clocks-disagree"),
    ];
    for (tamper, expected) in tampers {
        let mut rig = burger(1, with_wheels());
        let mut robot = ByImu::new();
        let moves = (0..200).any(|_| {
            rig.tick(|readings| robot.publish(readings))
                .command
                .forward_mps
                .abs()
                > 0.1
        });
        assert!(moves, "control: {expected}");
        for _ in 0..3 {
            let step = rig.tick(|readings| {
                robot.publish(readings);
                readings.joints.iter_mut().for_each(tamper);
            });
            let names: Vec<_> = step.faults.iter().map(Fault::name).collect();
            assert_eq!((step.command, names), (Speeds::REST, vec![expected]));
        }
        let step = (0..5)
            .map(|_| rig.tick(|readings| robot.publish(readings)))
            .last();
        assert_eq!(step.unwrap().faults, [], "control: {expected}");
    }
}
