//! How large recordings are.

use std::fs;
use std::path::Path;
use std::thread;

use crate::kit::program::expect;
use serde_json::Value;
use xcscr::agent::Method;

/// Bytes that recordings may take for each cell move, the story included.
const MOST: u64 = 2000;

/// What is recorded of so few episodes tells that of a default run to a quarter.
const FEW: &str = "45";

/// All recordings of a run, in bytes, and its steps.
fn recorded(folder: &Path, method: Method, episodes: &str) -> (u64, u64) {
    let run = folder.join(format!("{}-{episodes}", method.name()));
    let asked = ["train", "worlds/maze4.json", "--json", "--method"];
    let rest = ["--episodes", episodes, "--out", run.to_str().unwrap()];
    let (report, _) = expect(0, &[&asked[..], &[method.name()], &rest].concat());
    let report: Value = serde_json::from_str(&report).unwrap();
    let files = fs::read_dir(&run).unwrap().map(|entry| entry.unwrap());
    let recordings = files.filter(|file| file.path().extension().is_some_and(|e| e == "mcap"));
    let bytes = recordings.map(|file| file.metadata().unwrap().len()).sum();
    (bytes, report["steps"].as_u64().unwrap())
}

/// A default run keeps to the bound: one that comes near it is made whole.
fn keeps_to_the_bound(folder: &Path, method: Method) {
    let (bytes, steps) = recorded(folder, method, FEW);
    if bytes / steps < MOST * 3 / 4 {
        return;
    }
    let (bytes, steps) = recorded(folder, method, "180");
    let name = method.name();
    // 180 episodes, none of which can reach the goal in fewer than 10 steps.
    assert!(steps >= 1800, "{name}: {steps} steps");
    let each = bytes / steps;
    println!("{name}: {each} bytes a step, {steps} steps");
    assert!(each <= MOST, "{name}: {bytes} bytes for {steps} steps");
}

#[test]
fn a_default_run_of_any_method_takes_2000_bytes_for_each_cell_move_at_most() {
    let folder = tempfile::tempdir().unwrap();
    for some in Method::ALL.chunks(3) {
        thread::scope(|scope| {
            for &method in some {
                let folder = folder.path();
                scope.spawn(move || keeps_to_the_bound(folder, method));
            }
        });
    }
}
