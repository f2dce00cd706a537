//! Robot profiles as their users choose them.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::kit::program::expect;

/// Maze4 with cells of another size, in a folder.
fn maze4(folder: &Path, cell_size_m: f64) -> PathBuf {
    let text = fs::read_to_string("worlds/maze4.json").unwrap();
    let size = format!("\"cell_size_m\": {cell_size_m}");
    let resized = text.replace("\"cell_size_m\": 1.0", &size);
    assert_ne!(text, resized, "control");
    let file = folder.join("maze4.json");
    fs::write(&file, resized).unwrap();
    file
}

#[test]
fn a_robot_that_is_too_large_is_refused_before_work_starts_and_a_burger_learns_there() {
    let folder = tempfile::tempdir().unwrap();
    let (world, run) = (maze4(folder.path(), 0.5), folder.path().join("run"));
    let [world, out] = [&world, &run].map(|path| path.to_str().unwrap());
    let (_, message) = expect(65, &["train", world, "--out", out]);
    assert!(message.contains("does not fit"), "{message}");
    assert!(message.contains("column 1, row 1"), "{message}");
    assert!(!run.exists(), "{message}");
    let burger = ["--robot", "turtlebot3-burger", "--episodes", "30", "--json"];
    let train = [&["train", world, "--out", out], &burger[..]].concat();
    let report: Value = serde_json::from_str(&expect(0, &train).0).unwrap();
    assert_eq!(report["greedy_steps"], 10, "{report}");
    let config = fs::read_to_string(run.join("config.json")).unwrap();
    assert!(config.contains("\"max_speed_mps\": 0.22"), "{config}");
    let evaluation: Value =
        serde_json::from_str(&expect(0, &["evaluate", out, "--episodes", "20", "--json"]).0)
            .unwrap();
    assert_eq!(evaluation["successes"], 20, "{evaluation}");
}

#[test]
fn what_show_prints_is_a_profile_that_check_accepts() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("own.toml");
    let (profile, _) = expect(0, &["robot", "show", "turtlebot4-lite"]);
    fs::write(&own, &profile).unwrap();
    let own = own.to_str().unwrap();
    let (answer, _) = expect(0, &["robot", "check", own]);
    assert!(answer.contains("cells of at least 0.382 m"), "{answer}");
    let (answer, _) = expect(0, &["robot", "check", own, "--world", "worlds/maze4.json"]);
    assert!(answer.contains("fits into `maze4`"), "{answer}");
    let world = maze4(folder.path(), 0.25);
    expect(
        65,
        &["robot", "check", own, "--world", world.to_str().unwrap()],
    );
    let (settings, _) = expect(0, &["config", "show", "--robot", own, "--resolved"]);
    let line = settings
        .lines()
        .find(|line| line.starts_with("physics.radius_m"));
    assert!(
        line.unwrap().ends_with(&format!("# robot {own}")),
        "{line:?}"
    );
    let (names, _) = expect(0, &["robot", "list"]);
    assert_eq!(names.lines().count(), 4, "{names}");
    let (_, message) = expect(66, &["robot", "check", "turtlebot3-burgr"]);
    assert!(
        message.contains("did you mean `turtlebot3-burger`?"),
        "{message}"
    );
}

#[test]
fn a_study_runs_with_the_robot_that_its_file_names() {
    let folder = tempfile::tempdir().unwrap();
    maze4(folder.path(), 0.5);
    let study = |robot: &str| {
        let file = folder.path().join("study.toml");
        let text = format!(
            "name = \"small\"\nworlds = [\"maze4.json\"]\nmethods = [\"q-learning\"]\narenas = [\"physics\"]\ntrials = 1\nepisodes = 2\n{robot}"
        );
        fs::write(&file, text).unwrap();
        file
    };
    let out = folder.path().join("study");
    let run = |file: &Path, code: i32| {
        let [file, out] = [file, &out].map(|path| path.to_str().unwrap());
        expect(code, &["study", "run", file, "--out", out, "--quiet"])
    };
    let (_, message) = run(&study(""), 65);
    assert!(
        message.contains("does not fit into world `maze4`"),
        "{message}"
    );
    assert!(!out.exists(), "refused before work starts");
    let (_, message) = run(&study("robot = \"burger\"\n"), 65);
    assert!(message.contains("unknown robot `burger`"), "{message}");
    run(&study("robot = \"turtlebot3-burger\"\n"), 0);
    let plan = fs::read_to_string(out.join("plan.json")).unwrap();
    assert!(plan.contains("0.105"), "{plan}");
}

#[cfg(not(feature = "ros2"))]
#[test]
fn a_build_without_ros_2_says_how_to_get_it_and_still_refuses_another_robot() {
    let (_, message) = expect(2, &["simulate", "worlds/maze4.json", "--ros2"]);
    assert!(message.contains("--features ros2"), "{message}");
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    let out = run.to_str().unwrap();
    let short = ["--episodes", "2", "--record", "none"];
    let train = [&["train", "worlds/maze4.json", "--out", out], &short[..]].concat();
    expect(0, &train);
    let (_, message) = expect(2, &["drive", out, "--ros2"]);
    assert!(message.contains("--features ros2"), "{message}");
    let other = ["drive", out, "--ros2", "--robot", "turtlebot3-burger"];
    let (_, message) = expect(65, &other);
    assert!(message.contains("another robot"), "{message}");
    let (_, message) = expect(2, &["drive", out]);
    assert!(message.contains("--bag"), "{message}");
}
