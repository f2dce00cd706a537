//! `config show`: the settings, and where they come from.

use crate::kit::desk::Desk;

#[test]
fn config_show_names_the_maze_as_the_origin_of_what_it_decides() {
    let desk = Desk::new();
    let world = desk.ok("world generate --kind dfs --size 12");
    desk.write("winding.json", world);
    // Settings that were printed for a file give the same settings again.
    desk.write("common.toml", desk.ok("config show --method q-learning"));
    for (choice, wanted) in [
        ("", "600 # default"),
        ("--world @winding.json", "600 # default"),
        (
            "--method q-learning --world @winding.json",
            "176 # the maze",
        ),
        (
            "--method q-learning --world worlds/maze4.json",
            "50 # default",
        ),
        (
            "--world @winding.json --set reward.step_threshold=60",
            "60 # --set",
        ),
        (
            "--method q-learning --world @winding.json --config @common.toml",
            "176 # the maze",
        ),
    ] {
        let said = desk.ok(&format!("config show {choice}"));
        let mut lines = said.lines();
        let line = lines.find(|line| line.starts_with("reward.step_threshold "));
        let words: Vec<&str> = line.unwrap().split_whitespace().collect();
        assert_eq!(words[2..].join(" "), wanted, "{choice}");
    }
}

#[test]
fn config_show_names_the_robot_as_the_origin_of_what_its_profile_decides() {
    let desk = Desk::new();
    assert_eq!(desk.ok("robot show").lines().count(), 4);
    desk.write("own.toml", desk.ok("robot show turtlebot4-lite"));
    let settings = desk.ok("config show --robot @own.toml");
    let mut lines = settings.lines();
    let line = lines.find(|line| line.starts_with("physics.radius_m"));
    let origin = format!("# robot {}", desk.name("own.toml"));
    assert!(line.unwrap().ends_with(&origin), "{line:?}");
}

#[test]
fn config_show_prints_the_defaults_of_a_method() {
    let desk = Desk::new();
    let value = |method: &str, key: &str| {
        let all = desk.json(&format!("config show --json --method {method}"));
        all[key]["value"].clone()
    };
    assert_eq!(value("xcscr-plus", "xcs.population_size"), 1600);
    assert_eq!(value("xcscr", "xcs.population_size"), 3200);
    assert_eq!(value("xcscr-plus", "reward.sharing"), "even");
    let file = desk.ok("config show --method xcscr");
    let mut lines = file.lines();
    let line = lines.find(|line| line.starts_with("xcs.dont_care "));
    assert!(line.unwrap().contains("= 0.02 "), "{file}");
}
