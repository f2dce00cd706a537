//! Scans of other lidars than that of the robot's profile, as their drivers publish them.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use strum::VariantArray;

use xcscr::drive::DriveBag;
use xcscr::run::RunFolder;

use super::scans::drive_with;
use super::*;
use crate::kit::desk::Desk;

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

/// Sends 0 for no echo.
fn of_robotis(scan: Scan) -> Scan {
    let echo = |range: f64| if range.is_finite() { range } else { 0.0 };
    Scan {
        ranges_m: scan.ranges_m.iter().map(|&range| echo(range)).collect(),
        ..scan
    }
    .listed(ScanOrder::Reversed)
}

/// Scans of the LDS-01 (`hls_lfcd_lds_driver`).
fn lds_01(_: usize, scan: &Scan) -> Scan {
    of_robotis(scan.clone())
}

/// Scans of the LDS-02 (`ld08_driver`): the number of beams follows the speed of the motor.
fn lds_02(number: usize, scan: &Scan) -> Scan {
    let speed_dps = 1800.0 + 60.0 * (number as f64).sin();
    let (first_rad, last_rad) = (0.4_f64.to_radians(), 359.3_f64.to_radians());
    let increment_rad = (speed_dps / 2300.0).to_radians();
    let count = ((last_rad - first_rad) / increment_rad).ceil() as usize;
    let mut scan = with_beams(scan, count, first_rad, increment_rad, 0.0);
    scan.time_increment_s = 360.0 / speed_dps / count as f64;
    (scan.range_min_m, scan.range_max_m) = (0.0, 100.0);
    let mut scan = of_robotis(scan);
    for range in scan.ranges_m.iter_mut().step_by(37) {
        *range = f64::NAN;
    }
    scan
}

/// Scans of the LDS-03 (`coin_d4_driver`): one beam less than the increment tells.
fn lds_03(number: usize, scan: &Scan) -> Scan {
    let count = 395 + number % 9;
    let mut scan = with_beams(scan, count - 1, 0.0, TAU / count as f64, 0.0);
    (scan.range_min_m, scan.range_max_m) = (0.1, 100.0);
    of_robotis(scan)
}

/// Scans of the RPLIDAR on a TurtleBot 4 (`rplidar_ros`). The turn begins ahead of the robot, and the list
/// behind the lidar, which is turned by a quarter.
fn rplidar(_: usize, scan: &Scan) -> Scan {
    let turned = with_beams(scan, 269, -FRAC_PI_2, TAU / 268.0, FRAC_PI_2);
    Scan {
        frame: "rplidar_link".to_owned(),
        ..turned.listed(ScanOrder::ReversedFromFirst)
    }
}

fn transform(parent: &str, child: &str, x_m: f64, yaw_rad: f64) -> Transform {
    let turn = UnitQuaternion::from_euler_angles(0.0, 0.0, yaw_rad);
    Transform {
        parent: parent.to_owned(),
        child: child.to_owned(),
        pose: Isometry3::from_parts(Vector3::new(x_m, 0.0, 0.1).into(), turn),
    }
}

/// The scan with a number, as a driver publishes it.
type Model = fn(usize, &Scan) -> Scan;

/// Drives a robot to the goal with the policy of a run, and writes a bag of the messages as its lidar's
/// driver publishes them.
fn record(desk: &Desk, run: &str, profile: &str, mount: Transform, model: Model) {
    let folder = RunFolder::open(&desk.path(run));
    let (plan, knowledge) = (folder.plan().unwrap(), folder.knowledge().unwrap());
    let options = DriveOptions {
        robot: Some(RobotProfile::load(profile).unwrap()),
        ..DriveOptions::default()
    };
    let setup = DriveSetup::new(&plan, &knowledge, options).unwrap();
    let mut rig = Rig {
        robot: SimulatedRobot::new(maze4(), setup.physics(), 1, None).unwrap(),
        driver: Driver::new(setup),
        mount,
        odom: Isometry2::identity(),
        now_ns: 7_000_000_000,
    };
    let file = desk.path("bag.mcap");
    let mut bag = DriveBag::create(&file, true, &maze4(), rig.now_ns).unwrap();
    let mut counts = Vec::new();
    for _ in 0..8_000 {
        let mut arrived = Readings::default();
        let step = rig.tick(|readings| {
            for scan in &mut readings.scans {
                *scan = model(counts.len(), scan);
                counts.push(scan.ranges_m.len());
            }
            arrived = readings.clone();
        });
        bag.step(rig.now_ns, &arrived, &step).unwrap();
        let fault = step.faults.iter().find(|fault| fault.is_final());
        assert!(fault.is_none(), "{profile}: {fault:?}");
        if step.phase == Phase::AtGoal {
            return bag.finish().unwrap();
        }
    }
    panic!("{profile}: not over");
}

#[test]
fn bags_of_four_robots_drive_with_no_option_but_the_robot() {
    let desk = Desk::new();
    let [burger, turtlebot4] = ["turtlebot3-burger", "turtlebot4-lite"];
    for robot in [burger, turtlebot4] {
        desk.train(
            robot,
            &format!("maze4 --robot {robot} --episodes 40 --record none"),
        );
    }
    let robots: [(&str, Transform, Model); 4] = [
        (burger, mount(), lds_01),
        (burger, mount(), lds_02),
        (burger, mount(), lds_03),
        (
            turtlebot4,
            transform("base_link", "rplidar_link", 0.004, FRAC_PI_2),
            rplidar,
        ),
    ];
    for (number, (robot, mount, model)) in robots.into_iter().enumerate() {
        record(&desk, robot, robot, mount, model);
        let line = format!("drive @{robot} --bag @bag.mcap --robot {robot}");
        let said = desk.ok(&line);
        let all = "decisions are the same as in the recorded drive";
        assert!(said.contains(all), "{number}: {said}");
        // Without its order, the RPLIDAR of this slow robot leads to the same decisions.
        if robot == burger {
            desk.run(1, &format!("{line} --scan-order forward"));
        }
    }
}

#[test]
fn frames_with_a_prefix_need_the_option() {
    let prefixed = |readings: &mut Readings| {
        readings.static_transforms = vec![transform("tb4/base_link", "tb4/rplidar_link", 0.0, 0.0)];
        for odometry in &mut readings.odometry {
            odometry.frame = "tb4/odom".to_owned();
            odometry.child_frame = "tb4/base_link".to_owned();
        }
        for scan in &mut readings.scans {
            scan.frame = "tb4/rplidar_link".to_owned();
        }
    };
    for (prefix, is_wrong) in [("tb4/", false), ("", true)] {
        let options = DriveOptions {
            frames: Frames::default().with_prefix(prefix),
            ..DriveOptions::default()
        };
        let mut rig = Rig::new(maze4(), 1, options);
        let faults = (0..20).map(|_| rig.tick(prefixed)).last().unwrap().faults;
        let found = faults.iter().any(|fault| fault.name() == "wrong-frame");
        assert_eq!(found, is_wrong, "{prefix}: {faults:?}");
    }
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
    for &order in ScanOrder::VARIANTS {
        let again = scan.listed(order).in_order(order);
        assert_eq!(
            (again.stamp_ns, &again.ranges_m),
            (scan.stamp_ns, &scan.ranges_m)
        );
        assert!((again.angle_increment_rad - scan.angle_increment_rad).abs() < 1e-12);
    }
}

#[test]
fn scans_in_the_order_of_the_rplidar_need_that_order() {
    let ends_with = |scan_order: ScanOrder, seed: u64| {
        let options = DriveOptions {
            scan_order: Some(scan_order),
            ..DriveOptions::default()
        };
        let step = drive_with(&mut Rig::new(maze4(), seed, options), |readings| {
            for scan in &mut readings.scans {
                *scan = scan.listed(ScanOrder::ReversedFromFirst);
            }
        });
        let is_mislocalised = |fault: &Fault| matches!(fault, Fault::Mislocalised(_));
        (step.phase, step.faults.iter().any(is_mislocalised))
    };
    for seed in 1..=3 {
        let (phase, _) = ends_with(ScanOrder::ReversedFromFirst, seed);
        assert_eq!(phase, Phase::AtGoal, "seed {seed}");
        for wrong in [ScanOrder::Forward, ScanOrder::Reversed] {
            let (phase, is_mislocalised) = ends_with(wrong, seed);
            assert!(
                is_mislocalised,
                "control: {wrong:?}, seed {seed}: {phase:?}"
            );
        }
    }
}
