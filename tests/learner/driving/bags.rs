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

#[test]
fn a_drive_whose_robot_differs_ends_with_an_error_and_its_values_become_a_profile() {
    let desk = Desk::new();
    desk.train("run", "maze4 --arena physics --episodes 1 --record none");
    write_bag(&desk, "same.mcap", 300, |_| ());
    write_bag(&desk, "lossy.mcap", 300, |readings| {
        for scan in &mut readings.scans {
            scan.ranges_m
                .iter_mut()
                .step_by(7)
                .for_each(|range| *range = f64::INFINITY);
        }
    });
    let line = |bag: &str| {
        format!(
            "drive @run --bag @{bag}.mcap --compare --robot default --write-profile @{bag}.toml"
        )
    };
    let (stdout, stderr) = desk.run(1, &line("lossy"));
    assert!(
        stdout.contains("physics.lidar.dropouts") && stdout.contains("differs"),
        "{stdout}"
    );
    assert!(stderr.contains("1 of 9 values"), "{stdout}{stderr}");
    let (profile, shown) = (desk.text("lossy.toml"), desk.ok("robot show @lossy.toml"));
    let fitted = profile
        .lines()
        .find(|line| line.starts_with("physics.lidar.dropouts = 0."));
    let (value, source) = fitted.unwrap().split_once(" #").unwrap();
    assert!(shown.contains(value.trim()), "{shown}");
    assert!(source.contains("fitted to "), "{source}");
    let control = desk.ok(&line("same"));
    assert!(!control.contains("differs"), "{control}");
    desk.fails(73, &line("same"), "same.toml");
}
