//! Recorded drives.

use xcscr::drive::{DriveBag, DriveRecording};

use super::*;
use crate::kit::desk::Desk;

#[test]
fn a_recorded_drive_gives_the_same_decisions_again() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("drive.mcap");
    let mut rig = Rig::maze4();
    let mut bag = DriveBag::create(&file, false, &maze4(), rig.now_ns).unwrap();
    let (mut readings, mut decisions) = (Readings::default(), Vec::new());
    for _ in 0..300 {
        let step = rig.tick(|arrived| readings = arrived.clone());
        bag.step(rig.now_ns, &readings, &step).unwrap();
        decisions.extend(step.decision.map(|decision| decision.words));
    }
    bag.finish().unwrap();
    assert!(decisions.len() > 5, "control: {decisions:?}");
    let recording = DriveRecording::read(&file).unwrap();
    assert_eq!(recording.decisions, decisions);
    let mut again = Rig::maze4().driver;
    let steps = recording
        .readings
        .iter()
        .map(|(at, all)| again.step(*at, all));
    let words: Vec<String> = steps
        .filter_map(|step| Some(step.decision?.words))
        .collect();
    assert_eq!(words, decisions);
    let refused = DriveBag::create(&file, false, &maze4(), 0);
    assert!(refused.is_err(), "an earlier recording is kept");
}

/// Writes a bag of a robot that drives for some steps, without the decisions of its driver.
fn write_bag(desk: &Desk, name: &str, steps: usize, tamper: impl Fn(&mut Readings)) {
    let mut rig = Rig::maze4();
    let mut bag = DriveBag::create(&desk.path(name), false, &maze4(), rig.now_ns).unwrap();
    for _ in 0..steps {
        let mut readings = Readings::default();
        let step = rig.tick(|arrived| {
            tamper(arrived);
            readings = arrived.clone();
        });
        let step = DriverStep {
            decision: None,
            ..step
        };
        bag.step(rig.now_ns, &readings, &step).unwrap();
    }
    bag.finish().unwrap();
}

#[test]
fn a_bag_that_leads_to_no_decision_ends_with_an_error() {
    let desk = Desk::new();
    desk.train("run", "maze4 --arena physics --episodes 1 --record none");
    write_bag(&desk, "sound.mcap", 100, |_| ());
    write_bag(&desk, "blind.mcap", 100, |readings| readings.scans.clear());
    write_bag(&desk, "empty.mcap", 0, |_| ());
    let control = desk.ok("drive @run --bag @sound.mcap");
    assert!(control.ends_with(" decisions\n"), "{control}");
    for (bag, fault) in [("blind", "stops: "), ("empty", "")] {
        let (stdout, stderr) = desk.run(1, &format!("drive @run --bag @{bag}.mcap"));
        assert!(stdout.contains(fault), "{stdout}");
        assert!(stderr.contains("led to no decision"), "{stderr}");
    }
}

/// Log time and stamps jump together, such as when a clock is set while a bag is recorded.
#[test]
fn a_bag_whose_clocks_jump_together_ends_with_an_error_and_not_in_steps_of_the_whole_gap() {
    let desk = Desk::new();
    desk.train("run", "maze4 --arena physics --episodes 1 --record none");
    for (name, by_ns) in [
        ("small", 1_000_000_000),
        ("large", 1_700_000_000_000_000_000),
    ] {
        let mut rig = Rig::maze4();
        let path = desk.path(&format!("{name}.mcap"));
        let mut bag = DriveBag::create(&path, false, &maze4(), rig.now_ns).unwrap();
        for tick in 0..200 {
            let mut readings = Readings::default();
            let step = rig.tick(|arrived| readings = arrived.clone());
            let late_ns = if tick < 100 { 0 } else { by_ns };
            for odometry in &mut readings.odometry {
                odometry.stamp_ns += late_ns;
            }
            readings
                .imu
                .iter_mut()
                .for_each(|imu| imu.stamp_ns += late_ns);
            readings
                .scans
                .iter_mut()
                .for_each(|scan| scan.stamp_ns += late_ns);
            let step = DriverStep {
                decision: None,
                ..step
            };
            bag.step(rig.now_ns + late_ns, &readings, &step).unwrap();
        }
        bag.finish().unwrap();
    }
    let (stdout, stderr) = desk.run(1, "drive @run --bag @large.mcap");
    assert!(stdout.contains("the stamps of /odom jumped by"), "{stdout}");
    assert!(
        stderr.contains("the stamps of /odom jumped by"),
        "a final fault: {stderr}"
    );
    let control = desk.ok("drive @run --bag @small.mcap");
    assert!(!control.contains("jumped"), "{control}");
}

#[test]
fn options_of_a_node_are_refused_with_a_bag() {
    let desk = Desk::new();
    desk.train("run", "maze4 --arena physics --episodes 1 --record none");
    write_bag(&desk, "drive.mcap", 100, |_| ());
    desk.ok("drive @run --bag @drive.mcap --start 1.5,6.5,0 --laser 0,0,0");
    for option in [
        "--namespace /tb3",
        "--domain 7",
        "--remap scan:=front",
        "--sim-time",
        "--stamped",
        "--dry-run",
        "--out @other.mcap",
        "--force",
    ] {
        let line = format!("drive @run --bag @drive.mcap {option}");
        let (_, stderr) = desk.run(2, &line);
        assert!(stderr.contains("cannot be used with"), "{option}: {stderr}");
    }
}
