//! `config show`: what counts, and where it comes from.

use crate::kit::desk::Desk;
use serde_json::Value;

#[test]
fn config_show_names_the_maze_as_the_origin_of_what_it_decides() {
    let desk = Desk::new();
    let world = desk.ok("world generate --kind dfs --size 12");
    desk.write("winding.json", world);
    // Settings that were printed for a file give the same settings again.
    desk.write("all.toml", desk.ok("config show"));
    for (choice, wanted) in [
        ("", "50 # default"),
        ("--world @winding.json", "176 # the maze"),
        ("--world worlds/maze4.json", "50 # default"),
        (
            "--world @winding.json --set reward.step_threshold=60",
            "60 # --set",
        ),
        ("--world @winding.json --config @all.toml", "176 # the maze"),
    ] {
        let said = desk.ok(&format!("config show --resolved {choice}"));
        let mut lines = said.lines();
        let line = lines.find(|line| line.starts_with("reward.step_threshold "));
        let words: Vec<&str> = line.unwrap().split_whitespace().collect();
        assert_eq!(words[2..].join(" "), wanted, "{choice}");
    }
}

#[test]
fn config_show_names_the_robot_as_the_origin_of_what_its_profile_decides() {
    let desk = Desk::new();
    assert_eq!(desk.ok("robot list").lines().count(), 4);
    desk.write("own.toml", desk.ok("robot show turtlebot4-lite"));
    let settings = desk.ok("config show --robot @own.toml --resolved");
    let mut lines = settings.lines();
    let line = lines.find(|line| line.starts_with("physics.radius_m"));
    let origin = format!("# robot {}", desk.name("own.toml"));
    assert!(line.unwrap().ends_with(&origin), "{line:?}");
}

#[test]
fn config_show_lists_what_counts() {
    let desk = Desk::new();
    let keys = |choice: &str| -> Vec<String> {
        let all = desk.json(&format!("config show --json {choice}"));
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
    assert_eq!(keys("--method q-learning --arena grid"), table);
    let driven = keys("--method q-learning --arena physics");
    let counts = [table.len(), driven.len(), keys("").len()];
    assert!(counts.is_sorted_by(|a, b| a < b), "{driven:?}");
    assert!(driven.contains(&"physics.lidar.beams".to_owned()));
    let file = desk.ok("config show --method q-learning --arena grid");
    let has = |section: &str| file.contains(section);
    assert!(has("[tabular]") && !has("[xcs]"), "{file}");
    let all: Value = desk.json("config show --json --method xcsam");
    assert_eq!(all["xcs.zeta"]["read_by"], "`xcsam`");
}
