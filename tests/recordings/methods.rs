//! The size of recordings of runs of all methods.

use std::fs;

use crate::kit::desk::Desk;
use crate::kit::messages::count;
use rayon::prelude::*;
use xcscr::agent::Method;

/// Bytes that recordings may take for each cell move.
const MOST: u64 = 4600;

/// A run of a method with the default settings and half of the episodes. What a recording holds
/// besides steps weighs more in it than in a default run.
fn short_run(method: Method) -> Desk {
    let desk = Desk::new();
    let line = format!("maze4 --episodes 90 --method {}", method.name());
    desk.train("run", &line);
    desk
}

#[test]
fn a_run_of_any_method_takes_4600_bytes_for_each_cell_move_at_most() {
    Method::ALL.par_iter().for_each(|&method| {
        let desk = short_run(method);
        let files = fs::read_dir(desk.path("run")).unwrap().map(Result::unwrap);
        let recordings = files.filter(|file| file.path().extension().is_some_and(|e| e == "mcap"));
        let bytes: u64 = recordings.map(|file| file.metadata().unwrap().len()).sum();
        let steps = count(&desk.recording("run/run.mcap"), "/step");
        let what = format!("{}: {bytes} bytes for {steps} steps", method.name());
        // No episode can reach the goal in fewer than 10 steps.
        assert!(steps >= 900, "{what}");
        println!("{what}");
        assert!(bytes / steps <= MOST, "{what}");
    });
}
