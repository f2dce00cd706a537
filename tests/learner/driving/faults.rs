//! Tests each fault by tampering with the readings, with a control.

use std::f64::consts::PI;

use nalgebra::Isometry2;

use super::*;

#[test]
fn it_rests_when_scans_cease_and_goes_on_when_they_come_back() {
    let mut rig = Rig::maze4();
    let (steps, reported) = rig.steps_to_rest(|readings| readings.scans.clear());
    assert_eq!(reported, ["no-scans"]);
    // Two turns of 200 ms, and one period of 50 ms.
    assert!((5..=9).contains(&steps), "{steps}");
    assert!(rig.after(10).is_empty(), "control");
    assert_eq!(drive(&mut rig).0.phase, Phase::AtGoal);
}

#[test]
fn it_rests_when_odometry_ceases_and_goes_on_when_it_comes_back() {
    let mut rig = Rig::maze4();
    let (steps, reported) = rig.steps_to_rest(|readings| readings.odometry.clear());
    assert_eq!((steps, reported), (4, vec!["no-odometry"]));
    assert!(rig.after(10).is_empty(), "control");
    assert_eq!(drive(&mut rig).0.phase, Phase::AtGoal);
}

#[test]
fn stamps_that_jump_end_the_drive() {
    for by_ns in [-2_000_000_000_i64, 3_000_000_000] {
        let mut rig = Rig::maze4();
        let (steps, reported) = rig.steps_to_rest(|readings| {
            for odometry in &mut readings.odometry {
                odometry.stamp_ns = odometry.stamp_ns.saturating_add_signed(by_ns);
            }
        });
        assert_eq!((steps, reported[0]), (1, "clock-jumped"), "{by_ns}");
        assert!(rig.after(20).contains(&"clock-jumped"), "it lasts");
    }
    let mut rig = Rig::maze4();
    let (_, reported) = rig.steps_to_rest(|readings| {
        for scan in &mut readings.scans {
            scan.stamp_ns -= 700_000_000;
        }
    });
    assert_eq!(reported, ["clock-jumped"]);
}

#[test]
fn scans_with_another_clock_than_odometry_are_refused() {
    let mut rig = Rig::maze4();
    let off = |readings: &mut Readings| {
        let scans = readings.scans.iter_mut();
        scans.for_each(|scan| scan.stamp_ns += 5_000_000_000);
    };
    let last = (0..12).map(|_| rig.tick(off)).last().unwrap();
    assert_eq!(last.phase, Phase::Waiting);
    let names: Vec<_> = last.faults.iter().map(Fault::name).collect();
    assert!(names.contains(&"clocks-disagree"), "{names:?}");
}

#[test]
fn scans_that_are_mostly_not_numbers_are_a_fault_and_a_few_are_not() {
    let spoil = |share: f64| {
        move |readings: &mut Readings| {
            for scan in &mut readings.scans {
                let most = (share * scan.ranges_m.len() as f64) as usize;
                scan.ranges_m[..most].fill(f64::NAN);
            }
        }
    };
    let (steps, reported) = Rig::maze4().steps_to_rest(spoil(0.7));
    assert_eq!(reported, ["invalid-ranges"]);
    assert!(steps <= 4, "{steps}");
    let mut rig = Rig::maze4();
    rig.until_it_drives();
    for _ in 0..40 {
        assert_eq!(rig.tick(spoil(0.1)).faults, [], "control");
    }
}

#[test]
fn nan_in_odometry_is_a_fault_in_the_same_step() {
    let (steps, reported) = Rig::maze4().steps_to_rest(|readings| {
        readings.odometry[0].pose.translation.x = f64::NAN;
    });
    assert_eq!((steps, reported), (1, vec!["invalid-odometry"]));
}

#[test]
fn other_frames_and_another_lidar_are_faults() {
    let fault = |tamper: fn(&mut Readings)| Rig::maze4().steps_to_rest(tamper);
    let (steps, reported) = fault(|readings| readings.odometry[0].frame = "map".to_owned());
    assert_eq!((steps, reported), (1, vec!["wrong-frame"]));
    let (steps, reported) = fault(|readings| readings.odometry[0].child_frame = "arm".to_owned());
    assert_eq!((steps, reported), (1, vec!["wrong-frame"]));
    let (_, reported) = fault(|readings| {
        let scans = readings.scans.iter_mut();
        scans.for_each(|scan| scan.frame = "camera".to_owned());
    });
    assert_eq!(reported, ["no-laser-pose"]);
    let (_, reported) = fault(|readings| {
        let scans = readings.scans.iter_mut();
        scans.for_each(|scan| scan.ranges_m.truncate(20));
    });
    assert_eq!(reported, ["wrong-lidar"]);
    let (_, reported) = fault(|readings| {
        let scans = readings.scans.iter_mut();
        scans.for_each(|scan| scan.range_max_m = 2.5);
    });
    assert_eq!(reported, ["wrong-lidar"]);
    let mut rig = Rig::maze4();
    rig.until_it_drives();
    let slash = |readings: &mut Readings| readings.odometry[0].frame = "/odom".to_owned();
    assert_eq!(rig.tick(slash).faults, [], "control: the same frame");
}

#[test]
fn another_publisher_and_an_incompatible_peer_are_faults_while_they_last() {
    let mut rig = Rig::maze4();
    let (steps, reported) = rig.steps_to_rest(|readings| readings.network.other_publishers = 1);
    assert_eq!((steps, reported), (1, vec!["other-publisher"]));
    assert!(rig.after(2).is_empty(), "control");
    let (steps, reported) = rig.steps_to_rest(|readings| {
        let cause = "the subscriber wants transient-local messages".to_owned();
        readings.network.incompatible = vec![("/cmd_vel".to_owned(), cause)];
    });
    assert_eq!((steps, reported), (1, vec!["wrong-qos"]));
}

#[test]
fn an_interrupted_driver_rests_for_good() {
    let mut rig = Rig::maze4();
    rig.until_it_drives();
    rig.driver.interrupt();
    let step = rig.tick(|_| ());
    assert_eq!(
        (step.command, step.faults),
        (Speeds::default(), vec![Fault::Interrupted])
    );
    assert_eq!(rig.after(5), ["interrupted"]);
}

#[test]
fn a_robot_that_starts_elsewhere_than_configured_is_mislocalised() {
    let maze = maze4();
    let physics = Plan::new(maze.clone()).config.settings.physics;
    let start = maze.start().unwrap();
    let mut unnoticed = Vec::new();
    for cell in maze.free_cells().filter(|&cell| cell != start) {
        let mut rig = Rig::maze4();
        let at = maze.centre_m(cell);
        let elsewhere = Some([at.x, at.y, 0.0]);
        rig.robot = SimulatedRobot::new(maze.clone(), &physics, 1, elsewhere).unwrap();
        let found = (0..150).map(|_| rig.tick(|_| ())).find(|step| {
            let is_fault = |fault: &Fault| matches!(fault, Fault::Mislocalised(_));
            step.faults.iter().any(is_fault)
        });
        match found {
            Some(step) => assert_eq!(step.command, Speeds::default()),
            None => unnoticed.push((cell.col, cell.row)),
        }
    }
    assert_eq!(unnoticed, []);
}

#[test]
fn a_robot_that_is_carried_away_or_turned_is_mislocalised() {
    for pose in [
        Isometry2::translation(6.5, 1.5),
        Isometry2::new(nalgebra::Vector2::new(1.5, 6.5), PI / 3.0),
    ] {
        let mut rig = Rig::maze4();
        rig.until_it_drives();
        rig.robot.kidnap(pose);
        let names: Vec<_> = (0..40).flat_map(|_| rig.tick(|_| ()).faults).collect();
        assert!(
            matches!(names.last(), Some(Fault::Mislocalised(_))),
            "{names:?}"
        );
    }
}

#[test]
fn simulated_time_that_stands_still_or_runs_backward_is_a_fault() {
    let mut rig = Rig::maze4();
    let start_ns = STEP_NS;
    let clock = |at_ns: u64| move |readings: &mut Readings| readings.clock_ns = Some(at_ns);
    for step in 0..20 {
        let step = rig.tick(clock(start_ns + step * STEP_NS));
        assert!(!step.faults.iter().any(Fault::is_final), "{step:?}");
    }
    let still = (0..25).map(|_| rig.tick(clock(start_ns + 19 * STEP_NS)));
    let names: Vec<_> = still.flat_map(|step| step.faults).collect();
    assert!(names.iter().any(|f| f.name() == "no-clock"), "{names:?}");
    let back = rig.tick(clock(start_ns));
    let names: Vec<_> = back.faults.iter().map(Fault::name).collect();
    assert!(names.contains(&"clock-jumped"), "{names:?}");
}
