//! A panic in the middle of a drive. `tests/ros2_live.py` runs this test with a robot on the network.

use std::cell::Cell;
use std::path::PathBuf;
use std::time::SystemTime;

use xcscr::drive::{DriveOptions, DriveSetup, Driver, DriverOptions, NodeOptions, PoseSource};
use xcscr::ros2::DriveReport;
use xcscr::run::RunFolder;

/// The decision after which the drive panics, and the number of steps until it does.
const DECISION: u32 = 3;
const STEPS: u32 = 12;

#[test]
#[ignore = "needs a robot on ROS 2"]
#[should_panic(expected = "injected")]
fn a_panic_stops_the_robot() {
    let run = std::env::var_os("XCSCR_RUN").unwrap();
    let folder = RunFolder::open(&PathBuf::from(run));
    let (plan, knowledge) = (folder.plan().unwrap(), folder.knowledge().unwrap());
    let drive = DriveOptions {
        laser: Some([0.0; 3]),
        ..DriveOptions::default()
    };
    let setup = DriveSetup::new(&plan, &knowledge, drive).unwrap();
    let options = DriverOptions {
        node: NodeOptions {
            namespace: "/".to_owned(),
            domain: 0,
            localhost_only: false,
            remaps: Vec::new(),
        },
        sim_time: true,
        stamped: false,
        dry_run: false,
        source: PoseSource::Own,
        reads_joints: false,
    };
    let (decisions, steps) = (Cell::new(0), Cell::new(0));
    let stop = || {
        steps.set(steps.get() + u32::from(decisions.get() >= DECISION));
        if steps.get() > STEPS {
            let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
            println!("panics at {}", now.unwrap().as_secs_f64());
            panic!("injected");
        }
        false
    };
    let mut report = |report: DriveReport<'_>| {
        if let DriveReport::Step(step) = report {
            decisions.set(decisions.get() + u32::from(step.decision.is_some()));
        }
    };
    let _ = xcscr::ros2::drive(Driver::new(setup), &options, None, &stop, &mut report);
}
