//! Scans of other lidars than that of the robot's profile, as their drivers publish them.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::scans::{burger, drive_with, reverse, rig_of};
use super::*;

/// Returns the scan of a lidar with other beams than the simulated one, which is turned by `yaw_rad` on
/// the robot. It has `count` beams from `first_rad` on.
fn with_beams(scan: &Scan, count: usize, first_rad: f64, increment_rad: f64, yaw_rad: f64) -> Scan {
    let all = scan.ranges_m.len();
    let turn_s = scan.time_increment_s * all as f64;
    let range_m = |number: usize| {
        let angle_rad = first_rad + number as f64 * increment_rad + yaw_rad;
        let at = (angle_rad / TAU * all as f64).round() as i64;
        scan.ranges_m[at.rem_euclid(all as i64) as usize]
    };
    Scan {
        angle_min_rad: first_rad,
        angle_increment_rad: increment_rad,
        time_increment_s: turn_s / count as f64,
        ranges_m: (0..count).map(range_m).collect(),
        ..scan.clone()
    }
}

/// Sends 0 for no echo, and a range that no robot needs.
fn of_robotis(scan: Scan, range_min_m: f64) -> Scan {
    let echo = |range: f64| if range.is_finite() { range } else { 0.0 };
    Scan {
        range_min_m,
        range_max_m: 100.0,
        ranges_m: scan.ranges_m.iter().map(|&range| echo(range)).collect(),
        ..scan
    }
}

/// Scans of the LDS-02 (`ld08_driver`): the number of beams follows the speed of the motor.
fn lds_02(number: usize, scan: &Scan) -> Scan {
    let speed_dps = 1800.0 + 60.0 * (number as f64).sin();
    let (first_rad, last_rad) = (0.4_f64.to_radians(), 359.3_f64.to_radians());
    let increment_rad = (speed_dps / 2300.0).to_radians();
    let count = ((last_rad - first_rad) / increment_rad).ceil() as usize;
    let mut scan = of_robotis(with_beams(scan, count, first_rad, increment_rad, 0.0), 0.0);
    scan.time_increment_s = 360.0 / speed_dps / count as f64;
    for range in scan.ranges_m.iter_mut().step_by(37) {
        *range = f64::NAN;
    }
    scan
}

/// Scans of the LDS-03 (`coin_d4_driver`): one beam less than the increment tells.
fn lds_03(number: usize, scan: &Scan) -> Scan {
    let count = 395 + number % 9;
    of_robotis(
        with_beams(scan, count - 1, 0.0, TAU / count as f64, 0.0),
        0.1,
    )
}

#[test]
fn the_lidars_of_a_turtlebot3_drive_a_policy_that_was_trained_with_another_one() {
    let models: [fn(usize, &Scan) -> Scan; 2] = [lds_02, lds_03];
    for model in models {
        let options = DriveOptions {
            scan_order: ScanOrder::Reversed,
            ..DriveOptions::default()
        };
        let mut counts = Vec::new();
        let step = drive_with(&mut burger(1, options), |readings| {
            for scan in &mut readings.scans {
                *scan = model(counts.len(), scan);
                counts.push(scan.ranges_m.len());
            }
            reverse(readings);
        });
        assert_eq!(step.phase, Phase::AtGoal, "{step:?}");
        counts.sort_unstable();
        counts.dedup();
        assert!(counts.len() > 5, "control: {counts:?}");
    }
}

fn transform(parent: &str, child: &str, at: [f64; 3], yaw_rad: f64) -> Transform {
    let turn = UnitQuaternion::from_euler_angles(0.0, 0.0, yaw_rad);
    Transform {
        parent: parent.to_owned(),
        child: child.to_owned(),
        pose: Isometry3::from_parts(Vector3::from(at).into(), turn),
    }
}

/// A TurtleBot 4 whose lidar has 269 beams and 7.7 turns a second, with a prefix before its frames.
fn turtlebot4(options: DriveOptions) -> (Rig, impl Fn(&mut Readings)) {
    let mut rig = rig_of("turtlebot4-lite", maze4(), 1, options);
    let mut plan = Plan::new(maze4());
    let profile = RobotProfile::load("turtlebot4-lite").unwrap();
    plan.config.settings = profile.settings_over(&plan.config.settings).unwrap();
    let mut physics = plan.config.settings.physics;
    physics.lidar.rate_hz = 7.7;
    rig.robot = SimulatedRobot::new(maze4(), &physics, 1, None).unwrap();
    let as_published = |readings: &mut Readings| {
        readings.static_transforms = vec![
            transform("tb4/base_link", "tb4/shell_link", [0.0, 0.0, 0.09], 0.0),
            transform(
                "tb4/shell_link",
                "tb4/rplidar_link",
                [0.0, 0.0, 0.05],
                FRAC_PI_2,
            ),
        ];
        for odometry in &mut readings.odometry {
            odometry.frame = "tb4/odom".to_owned();
            odometry.child_frame = "tb4/base_link".to_owned();
        }
        for scan in &mut readings.scans {
            // The turn begins ahead of the robot, and the list behind the lidar.
            let turned = with_beams(scan, 269, -FRAC_PI_2, TAU / 268.0, FRAC_PI_2);
            *scan = turned.in_order(ScanOrder::ReversedFromFirst);
            scan.frame = "tb4/rplidar_link".to_owned();
        }
    };
    (rig, as_published)
}

#[test]
fn the_lidar_of_a_turtlebot_4_drives_by_the_pose_in_the_static_transforms() {
    let options = DriveOptions {
        frames: Frames::default().with_prefix("tb4/"),
        scan_order: ScanOrder::ReversedFromFirst,
        ..DriveOptions::default()
    };
    let (mut rig, as_published) = turtlebot4(options);
    let step = drive_with(&mut rig, as_published);
    assert_eq!(step.phase, Phase::AtGoal, "{step:?}");
    let (mut rig, as_published) = turtlebot4(DriveOptions::default());
    let faults = (0..20)
        .map(|_| rig.tick(&as_published))
        .last()
        .unwrap()
        .faults;
    let names: Vec<_> = faults.iter().map(Fault::name).collect();
    assert!(names.contains(&"wrong-frame"), "control: {names:?}");
}

#[test]
fn without_the_pose_of_the_lidar_the_robot_does_not_move() {
    let mut rig = Rig::maze4();
    for _ in 0..40 {
        let step = rig.tick(|readings| readings.static_transforms.clear());
        assert_eq!(step.command, Speeds::REST);
        assert_eq!(step.phase, Phase::Waiting);
    }
    let faults = rig.tick(|_| ()).faults;
    let is_unknown = |fault: &Fault| fault.name() == "no-laser-pose";
    assert!(faults.iter().any(is_unknown), "{faults:?}");
    let options = DriveOptions {
        laser: Some([0.0; 3]),
        ..DriveOptions::default()
    };
    let mut rig = Rig::new(maze4(), 1, options);
    let step = drive_with(&mut rig, |readings| readings.static_transforms.clear());
    assert_eq!(step.phase, Phase::AtGoal, "control: it is given");
}

#[test]
fn a_scan_that_is_unsafe_to_drive_by_stops_the_robot_while_it_lasts() {
    let spoil: [fn(&mut Scan); 12] = [
        |scan| scan.angle_min_rad = f64::NAN,
        |scan| scan.angle_min_rad = 1e300,
        |scan| scan.angle_increment_rad = f64::NAN,
        |scan| scan.angle_increment_rad = 0.0,
        |scan| scan.angle_increment_rad *= 0.5,
        |scan| scan.time_increment_s = f64::NAN,
        |scan| scan.time_increment_s = -0.001,
        |scan| scan.range_min_m = f64::NAN,
        |scan| scan.range_min_m = 2.0,
        |scan| scan.range_max_m = f64::NAN,
        |scan| scan.range_max_m = 1.0,
        |scan| scan.ranges_m = vec![1.0; 20_000],
    ];
    for (number, spoil) in spoil.into_iter().enumerate() {
        let mut rig = Rig::maze4();
        let (steps, reported) =
            rig.steps_to_rest(|readings| readings.scans.iter_mut().for_each(spoil));
        assert_eq!(reported, ["wrong-lidar"], "value {number}");
        assert!(steps <= 4, "value {number}: {steps}");
        assert!(rig.after(5).is_empty(), "control: value {number}");
    }
}

#[test]
fn beams_that_are_listed_from_the_last_to_the_first_have_their_times() {
    let scan = Scan {
        stamp_ns: 1_000_000_000,
        angle_increment_rad: PI / 2.0,
        time_increment_s: 0.05,
        ranges_m: vec![1.0, 2.0, 3.0, 4.0],
        ..Scan::default()
    };
    let reversed = scan.in_order(ScanOrder::Reversed);
    assert_eq!(reversed.stamp_ns, 850_000_000);
    assert_eq!(reversed.ranges_m, [4.0, 3.0, 2.0, 1.0]);
    let from_first = scan.in_order(ScanOrder::ReversedFromFirst);
    assert_eq!(from_first.stamp_ns, scan.stamp_ns);
    assert_eq!(from_first.ranges_m, reversed.ranges_m);
    assert_eq!(scan.in_order(ScanOrder::Forward), scan, "control");
}
