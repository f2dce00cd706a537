//! Settings that cannot have an effect are refused.

use std::fs;

use serde_json::Value;

use crate::kit::program::expect;

/// The arguments of a short training in a folder.
fn train<'a>(out: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let first = [
        "train",
        "worlds/maze4.json",
        "--episodes",
        "1",
        "--out",
        out,
    ];
    [&first, more].concat()
}

#[test]
fn train_refuses_what_its_method_arena_or_percept_does_not_read() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    let out = run.to_str().unwrap();
    let grid = ["--arena", "grid", "--method"];
    for (set, choice, why) in [
        (
            "xcs.beta=0.1",
            "q-learning",
            "the method `q-learning` does not read it; `xcs`, ",
        ),
        ("xcs.population_size=64", "q-learning", "`xcscr-plus` do"),
        (
            "physics.noise=0",
            "xcs",
            "the arena `grid` does not read it; the arena `physics` does",
        ),
        (
            "episode.explore=0.1",
            "xcscr-plus",
            "`xcscr-plus` with `plus.planned_exploration=false`",
        ),
    ] {
        let args = [&grid[..], &[choice, "--set", set]].concat();
        let (_, message) = expect(65, &train(out, &args));
        let key = set.split('=').next().unwrap();
        let told = message.contains(&format!("--set: `{key}` has no effect: "));
        assert!(told && message.contains(why), "{message}");
        assert!(!run.exists(), "{message}");
    }
    let beams = ["--sensor", "neighbours", "--set", "physics.lidar.beams=16"];
    let (_, message) = expect(65, &train(out, &beams));
    assert!(
        message.contains("a robot with the percept `neighbours` does not read it"),
        "{message}"
    );
    let (_, message) = expect(
        65,
        &train(out, &["--arena", "grid", "--robot", "turtlebot3-burger"]),
    );
    assert!(
        message.contains("the arena `grid` has no robot"),
        "{message}"
    );
    // What counts is taken.
    let sets = [
        "--set",
        "xcs.beta=0.1",
        "--set",
        "physics.noise=0",
        "--method",
        "xcs",
    ];
    expect(0, &train(out, &sets));
}

#[test]
fn a_settings_file_may_repeat_defaults_but_not_change_what_has_no_effect() {
    let folder = tempfile::tempdir().unwrap();
    let [file, out] = ["settings.toml", "run"].map(|name| folder.path().join(name));
    let (all, _) = expect(0, &["config", "show"]);
    let [path, out] = [&file, &out].map(|path| path.to_str().unwrap());
    let args = [
        "--arena",
        "grid",
        "--method",
        "q-learning",
        "--config",
        path,
    ];
    fs::write(&file, all.replace("mu = 0.04", "mu = 0.05")).unwrap();
    let (_, message) = expect(65, &train(out, &args));
    assert!(
        message.contains("settings.toml: `xcs.mu` has no effect"),
        "{message}"
    );
    fs::write(&file, &all).unwrap();
    expect(0, &train(out, &args));
    // The run's own files hold all settings, and are read again.
    expect(0, &["train", "--resume", out]);
}

#[test]
fn evaluate_refuses_what_only_learning_reads() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    let out = run.to_str().unwrap();
    expect(0, &train(out, &["--arena", "grid", "--method", "xcs"]));
    let evaluate = |set| ["evaluate", out, "--episodes", "1", "--set", set];
    let (_, message) = expect(65, &evaluate("xcs.beta=0.1"));
    assert!(
        message.contains("the policy only drives here, and does not learn"),
        "{message}"
    );
    let (_, message) = expect(65, &evaluate("physics.noise=0"));
    assert!(
        message.contains("the arena `grid` does not read it"),
        "{message}"
    );
    expect(0, &evaluate("arena.slip=0.1"));
}

#[test]
fn config_show_lists_what_counts() {
    let keys = |choice: &[&str]| -> Vec<String> {
        let args = [&["config", "show", "--json"], choice].concat();
        let all: Value = serde_json::from_str(&expect(0, &args).0).unwrap();
        all.as_object().unwrap().keys().cloned().collect()
    };
    let table = [
        "arena.slip",
        "episode.alternate",
        "episode.explore",
        "reward.collision",
        "reward.gamma",
        "reward.goal",
        "reward.step",
        "reward.step_threshold",
        "reward.step_threshold_from_maze",
        "sensor.flip_probability",
        "tabular.alpha",
    ];
    assert_eq!(keys(&["--method", "q-learning", "--arena", "grid"]), table);
    let all = keys(&[]);
    let driven = keys(&["--method", "q-learning", "--arena", "physics"]);
    assert!(
        driven.len() > table.len() && driven.len() < all.len(),
        "{driven:?}"
    );
    assert!(driven.contains(&"physics.lidar.beams".to_owned()));
    let (file, _) = expect(
        0,
        &[
            "config",
            "show",
            "--method",
            "q-learning",
            "--arena",
            "grid",
        ],
    );
    assert!(
        file.contains("[tabular]") && !file.contains("[xcs]"),
        "{file}"
    );
    let refused = [
        "config",
        "show",
        "--method",
        "q-learning",
        "--set",
        "xcs.mu=0.1",
    ];
    let (_, message) = expect(65, &refused);
    assert!(message.contains("`xcs.mu` has no effect"), "{message}");
    let (line, _) = expect(0, &["config", "show", "--json", "--method", "xcsam"]);
    let all: Value = serde_json::from_str(&line).unwrap();
    assert_eq!(all["xcs.zeta"]["read_by"], "`xcsam`");
}
