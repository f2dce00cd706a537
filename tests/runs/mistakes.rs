//! What a new user types by mistake, and what the program answers.

use std::fs;

use super::kit::program::{expect, outcome};

/// Arguments that are wrong, and what the message says.
const MISTAKES: [(&[&str], i32, &str); 9] = [
    (
        &["evaluate", "worlds/maze4.json"],
        65,
        "worlds/maze4.json is a world, not a learned policy: train in it with `xcscr train worlds/maze4.json`",
    ),
    (
        &["train", "assets/results/flips.toml"],
        65,
        "run a study file with `xcscr study run FILE`",
    ),
    (&["train", "maze44"], 66, "did you mean maze4"),
    (&["study", "run", "papr"], 66, "paper"),
    (
        &["train", "maze4", "--method", "qlearning"],
        2,
        "a similar value exists: 'q-learning'",
    ),
    (
        &["train", "maze4", "--set", "beta=0.1"],
        65,
        "did you mean `xcs.beta`?",
    ),
    (
        &["train", "maze4", "--seed", "-1"],
        2,
        "a seed is a whole number from 0 to",
    ),
    (
        &["recording", "check", "worlds"],
        66,
        "worlds holds no recordings",
    ),
    (
        &["rules", "worlds/maze4.json"],
        65,
        "is a world, not a learned policy",
    ),
];

#[test]
fn nine_mistakes_are_answered_with_what_to_do() {
    for (args, code, words) in MISTAKES {
        let (found, stdout, stderr) = outcome(args);
        assert_eq!(found, Some(code), "{args:?}: {stdout}{stderr}");
        assert!(stderr.contains(words), "{args:?}: {stderr}");
    }
}

#[test]
fn bundled_worlds_are_found_by_name_and_runs_and_recordings_in_place_of_each_other() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    let run = run.to_str().unwrap();
    let train = ["train", "maze4", "--arena", "grid", "--episodes", "3"];
    expect(0, &[&train[..], &["--out", run, "--quiet"]].concat());
    let (checked, _) = expect(0, &["recording", "check", run]);
    let files = fs::read_dir(run).unwrap();
    let recordings = files.filter(|file| {
        let name = file.as_ref().unwrap().file_name();
        name.to_string_lossy().ends_with(".mcap")
    });
    assert_eq!(checked.lines().count(), recordings.count(), "{checked}");
    let last = format!("{run}/ep-0003.mcap");
    let [of_run, of_last] = [run, &last].map(|path| expect(0, &["rules", path]).0);
    assert_eq!(of_run, of_last);
    let first = format!("{run}/ep-0001.mcap");
    assert_ne!(
        of_run,
        expect(0, &["rules", &first]).0,
        "control: earlier rules"
    );
}
