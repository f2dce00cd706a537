//! The contract of the command line: what goes where, the exit codes, and what the program answers to
//! mistakes of new users.

use std::fs;

use crate::kit::desk::Desk;
use crate::kit::script;

#[test]
fn help_documents_every_exit_code() {
    let help = Desk::new().ok("--help");
    for code in ["0", "1", "2", "65", "66", "70", "73", "74", "75"] {
        let mut lines = help.lines().map(str::trim_start);
        let listed = lines.any(|line| line.starts_with(&format!("{code}  ")));
        assert!(listed, "{code} is missing in\n{help}");
    }
}

#[test]
fn what_is_refused_has_its_code_says_what_to_do_prints_no_result_and_changes_nothing() {
    script::run(include_str!("refused.txt"));
}

#[test]
fn what_is_not_said_is_chosen_for_the_world_and_what_cannot_succeed_is_said() {
    script::run(include_str!("training.txt"));
}

#[cfg(not(feature = "ros2"))]
#[test]
fn a_build_without_ros_2_says_how_to_get_it_and_still_refuses_another_robot() {
    script::run_at(
        &Desk::new(),
        "train run maze4 --episodes 2
         2 simulate worlds/maze4.json --ros2 => --features ros2
         2 drive @run --ros2 => --features ros2
         65 drive @run --ros2 --robot turtlebot3-burger => a different robot",
    );
}

/// What is no recording gets no such advice, see `refused.txt`.
#[test]
fn a_damaged_recording_gets_advice() {
    let desk = Desk::new();
    let sound = fs::read("recordings/sample-maze4.mcap").unwrap();
    desk.write("damaged.mcap", &sound[..sound.len() / 2]);
    let info = "recording info @damaged.mcap";
    desk.fails(65, info, "`mcap recover`");
}

#[test]
fn show_draws_the_maze() {
    insta::assert_snapshot!(Desk::new().ok("world show worlds/maze4.json"), @r"
    ████████████████
    ██S   ██      ██
    ████    ██    ██
    ████  ██    ████
    ██            ██
    ████  ██      ██
    ██        ██G ██
    ████████████████
    ");
}

#[test]
fn info_tells_size_paths_and_cells_that_look_alike() {
    insta::assert_snapshot!(Desk::new().ok("world info worlds/maze4.json"));
}

#[test]
fn info_with_json_prints_one_json_document() {
    let desk = Desk::new();
    for world in ["maze4", "woods1"] {
        let (stdout, stderr) = desk.run(0, &format!("world info --json worlds/{world}.json"));
        let document: serde_json::Value = serde_json::from_str(&stdout).unwrap();
        assert_eq!(document["world"], world);
        assert_eq!(stderr, "");
    }
}
