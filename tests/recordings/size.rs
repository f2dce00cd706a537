//! How large recordings are.

use std::fs;
use std::path::Path;
use std::thread;

use crate::kit::program::expect;
use xcscr::agent::Method;
use xcscr::record::reader::Recording;

/// Bytes that recordings may take for each cell move, the highlights recording included.
const MOST: u64 = 2000;

/// All recordings of a default run, in bytes, and its steps.
fn recorded(folder: &Path, method: Method) -> (u64, u64) {
    let run = folder.join(method.name());
    let out = run.to_str().unwrap();
    let asked = ["train", "worlds/maze4.json", "--quiet", "--out", out];
    expect(0, &[&asked[..], &["--method", method.name()]].concat());
    let files = fs::read_dir(&run).unwrap().map(|entry| entry.unwrap());
    let recordings = files.filter(|file| file.path().extension().is_some_and(|e| e == "mcap"));
    let bytes = recordings.map(|file| file.metadata().unwrap().len()).sum();
    let whole = Recording::open(&run.join("run.mcap")).unwrap();
    let messages = whole.messages().map(|message| message.unwrap());
    let steps = messages.filter(|message| message.topic() == "/step");
    (bytes, steps.count() as u64)
}

/// A default run keeps to the bound.
fn keeps_to_the_bound(folder: &Path, method: Method) {
    let (bytes, steps) = recorded(folder, method);
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
