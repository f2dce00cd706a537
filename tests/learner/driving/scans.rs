//! Scans as the drivers of the TurtleBot3 publish them.

use nalgebra::Isometry2;

use super::*;

/// Creates a TurtleBot3 Burger in Maze4.
pub fn burger(seed: u64, options: DriveOptions) -> Rig {
    burger_in(maze4(), seed, options)
}

/// Creates a TurtleBot3 Burger in a world. Its lidar has a range of 3.5 m.
pub fn burger_in(maze: Maze, seed: u64, options: DriveOptions) -> Rig {
    let (mut plan, knowledge) = policy(maze, |_| false);
    let profile = RobotProfile::load("turtlebot3-burger").unwrap();
    plan.config.settings = profile.settings_over(&plan.config.settings).unwrap();
    let physics = plan.config.settings.physics.clone();
    let setup = DriveSetup::new(&plan, &knowledge, options).unwrap();
    Rig {
        robot: SimulatedRobot::new(plan.maze, &physics, seed, None).unwrap(),
        driver: Driver::new(setup),
        mount: mount(),
        odom: Isometry2::identity(),
        now_ns: 7_000_000_000,
    }
}

/// Replaces infinity by 0, as the LDS-01 does. Returns the number of zeros.
fn zeros(readings: &mut Readings) -> usize {
    let ranges = readings
        .scans
        .iter_mut()
        .flat_map(|scan| &mut scan.ranges_m);
    let nothing = ranges.filter(|range| **range == f64::INFINITY);
    nothing.map(|range| *range = 0.0).count()
}

/// Lists the beams of a scan from the last to the first, with the time of the last one as the stamp.
fn reverse(readings: &mut Readings) {
    for scan in &mut readings.scans {
        *scan = scan.listed(ScanOrder::Reversed);
    }
}

/// Drives to the end with tampered readings. Returns the last step.
pub fn drive_with(rig: &mut Rig, mut tamper: impl FnMut(&mut Readings)) -> DriverStep {
    for _ in 0..8_000 {
        let step = rig.tick(&mut tamper);
        let has_failed = step.faults.iter().any(Fault::is_final);
        if step.phase == Phase::AtGoal || has_failed {
            return step;
        }
    }
    panic!("not over after 400 s");
}

#[test]
fn a_range_of_zero_is_no_return() {
    let mut none = 0;
    for seed in 1..=3 {
        let mut plain = burger(seed, DriveOptions::default());
        let infinite = drive_with(&mut plain, |_| ());
        let mut rig = burger(seed, DriveOptions::default());
        let zero = drive_with(&mut rig, |readings| none += zeros(readings));
        assert_eq!(zero, infinite, "seed {seed}");
        assert_eq!(zero.phase, Phase::AtGoal, "seed {seed}");
    }
    assert!(none > 1_000, "control: {none}");
}

#[test]
fn a_range_below_the_minimum_is_an_obstacle_and_zero_is_not() {
    let scan = Scan {
        range_min_m: 0.12,
        range_max_m: 3.5,
        ranges_m: vec![0.0, -0.0, 0.05, f64::NEG_INFINITY, 0.12, 3.5, 3.6, f64::NAN],
        ..Scan::default()
    };
    let near = Some(0.12);
    let measured: Vec<_> = (0..9).map(|number| scan.measured_m(number)).collect();
    let expected = [None, None, near, near, near, Some(3.5), None, None, None];
    assert_eq!(measured, expected);
}

#[test]
fn scans_of_the_lds_01_need_an_option_and_reach_the_goal_with_it() {
    let as_published = |readings: &mut Readings| {
        zeros(readings);
        reverse(readings);
    };
    for seed in 1..=3 {
        let options = DriveOptions {
            scan_order: Some(ScanOrder::Reversed),
            ..DriveOptions::default()
        };
        let step = drive_with(&mut burger(seed, options), as_published);
        assert_eq!(step.phase, Phase::AtGoal, "seed {seed}: {step:?}");
    }
    let mut rig = burger(1, DriveOptions::default());
    for _ in 0..40 {
        let step = rig.tick(as_published);
        assert_eq!(step.command, Speeds::default(), "{step:?}");
    }
    let faults = rig.tick(as_published).faults;
    let is_ahead = |fault: &Fault| fault.name() == "scan-ahead";
    assert!(faults.iter().any(is_ahead), "{faults:?}");
}

#[test]
fn a_covered_lidar_and_one_that_does_not_turn_stop_the_robot_until_they_work_again() {
    let covered = |readings: &mut Readings| {
        for scan in &mut readings.scans {
            scan.ranges_m.fill(0.0);
        }
    };
    let standing = |readings: &mut Readings| {
        for scan in &mut readings.scans {
            scan.time_increment_s = f64::INFINITY;
        }
    };
    let tampers: [fn(&mut Readings); 2] = [covered, standing];
    for (name, tamper) in ["no-returns", "wrong-lidar"].into_iter().zip(tampers) {
        let mut rig = burger(1, DriveOptions::default());
        let moves = (0..100).any(|_| rig.tick(|_| ()).command != Speeds::default());
        assert!(moves, "control: it drives with a lidar that works");
        let stops = (0..20).any(|_| {
            let step = rig.tick(tamper);
            step.faults.iter().any(|fault| fault.name() == name)
        });
        assert!(stops, "no {name}");
        assert_eq!(rig.tick(tamper).command, Speeds::default(), "{name}");
        let step = drive_with(&mut rig, |_| ());
        assert_eq!(step.phase, Phase::AtGoal, "{name}: {step:?}");
    }
}

#[test]
fn a_hall_is_crossed_in_whose_middle_the_lidar_sees_no_wall() {
    let [wall, row] = ["#############", "#...........#"];
    let rows = [
        wall,
        row,
        row,
        row,
        row,
        "#S.........G#",
        row,
        row,
        row,
        row,
        wall,
    ];
    let json = serde_json::json!({ "name": "hall", "rows": rows }).to_string();
    let hall = Maze::from_json(json.as_bytes(), "hall.json").unwrap();
    let mut fewest = usize::MAX;
    let step = drive_with(
        &mut burger_in(hall, 1, DriveOptions::default()),
        |readings| {
            for scan in &readings.scans {
                let echoes = scan.ranges_m.iter().filter(|range| range.is_finite());
                fewest = fewest.min(echoes.count());
            }
        },
    );
    assert_eq!(step.phase, Phase::AtGoal, "{step:?}");
    assert!(fewest < 8, "control: {fewest} beams return");
}
