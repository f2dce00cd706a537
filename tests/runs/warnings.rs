//! What cannot succeed is said before the work starts, and the default step limit fits the maze.

use std::fs;
use std::path::{Path, PathBuf};

use crate::kit::program::expect;
use serde_json::Value;

/// A winding maze whose shortest path has 44 steps.
fn winding(folder: &Path) -> PathBuf {
    let args = ["world", "generate", "--kind", "dfs", "--size", "12"];
    let file = folder.join("winding.json");
    fs::write(&file, expect(0, &args).0).unwrap();
    file
}

fn json(text: &[u8]) -> Value {
    serde_json::from_slice(text).unwrap()
}

#[test]
fn the_default_step_limit_follows_the_maze_and_the_run_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let (world, out) = (winding(folder.path()), folder.path().join("run"));
    let (world, run) = (world.to_str().unwrap(), out.to_str().unwrap());
    let sensor = ["--sensor", "neighbours-position"];
    let train = ["train", world, "--arena", "grid", "--episodes", "20"];
    let method = ["--method", "r-max", "--out", run, "--quiet", "--json"];
    let (report, stderr) = expect(0, &[&train[..], &method, &sensor].concat());
    assert_eq!(stderr, "");
    let reward = json(&fs::read(out.join("config.json")).unwrap())["settings"]["reward"].clone();
    assert_eq!(reward["step_threshold"], 176);
    assert_eq!(reward["step_threshold_from_maze"], true);
    assert!(json(report.as_bytes())["first_optimal_episode"].is_u64());
    expect(0, &["recording", "verify", run]);
    let (again, _) = expect(0, &["evaluate", run, "--json", "--episodes", "1"]);
    assert_eq!(json(again.as_bytes())["optimal"], 1);
}

#[test]
fn config_show_names_the_maze_as_the_origin_of_what_it_decides() {
    let folder = tempfile::tempdir().unwrap();
    let world = winding(folder.path());
    let show = ["config", "show", "--resolved"];
    let line = |more: &[&str]| {
        let (said, _) = expect(0, &[&show[..], more].concat());
        let line = said
            .lines()
            .find(|line| line.starts_with("reward.step_threshold "));
        line.unwrap()
            .split_whitespace()
            .collect::<Vec<_>>()
            .join(" ")
    };
    let world = ["--world", world.to_str().unwrap()];
    assert_eq!(line(&[]), "reward.step_threshold = 50 # default");
    assert_eq!(line(&world), "reward.step_threshold = 176 # the maze");
    let maze4 = ["--world", "worlds/maze4.json"];
    assert_eq!(line(&maze4), "reward.step_threshold = 50 # default");
    let set = [&world[..], &["--set", "reward.step_threshold=60"]].concat();
    assert_eq!(line(&set), "reward.step_threshold = 60 # --set");
}

#[test]
fn settings_that_were_printed_for_a_file_give_the_same_settings_again() {
    let folder = tempfile::tempdir().unwrap();
    let (world, file) = (winding(folder.path()), folder.path().join("all.toml"));
    let (printed, _) = expect(0, &["config", "show"]);
    fs::write(&file, &printed).unwrap();
    let [world, file] = [&world, &file].map(|path| path.to_str().unwrap());
    let args = ["config", "show", "--resolved", "--config", file];
    let (said, _) = expect(0, &[&args[..], &["--world", world]].concat());
    assert!(said.contains("= 176          # the maze"), "{said}");
}

#[test]
fn train_warns_before_it_works() {
    let folder = tempfile::tempdir().unwrap();
    let (world, out) = (winding(folder.path()), folder.path().join("run"));
    let [world, run] = [&world, &out].map(|path| path.to_str().unwrap());
    let train = ["train", world, "--arena", "grid", "--episodes", "1"];
    let method = ["--method", "xcscr", "--out", run, "--quiet"];
    let sets = ["--set", "reward.step_threshold=43"];
    let (_, stderr) = expect(0, &[&train[..], &method, &sets].concat());
    let lines: Vec<&str> = stderr.lines().collect();
    for (line, words) in lines
        .iter()
        .zip(["--set reward.step_threshold=176", "`--method xcscr-plus`"])
    {
        assert!(
            line.starts_with("warning: ") && line.contains(words),
            "{stderr}"
        );
    }
    assert_eq!(lines.len(), 2, "{stderr}");
}

#[test]
fn a_study_warns_once_for_each_world_and_the_preset_of_the_paper_keeps_its_step_limit() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let text = "name = \"s\"\nworlds = [\"maze4\", \"dfs-12-1\"]\nmethods = [\"xcs\", \"xcscr\"]\ntrials = 1\nepisodes = 1\n";
    fs::write(path("s.toml"), text).unwrap();
    let run = ["study", "run"];
    let out = ["--jobs", "1", "--quiet", "--out"];
    let (study, found) = (path("s.toml"), path("found"));
    let args = [&run[..], &[&study], &out, &[&found]].concat();
    let (_, stderr) = expect(0, &args);
    let warned: Vec<&str> = stderr.lines().collect();
    assert_eq!(warned.len(), 1, "{stderr}");
    assert!(
        warned[0].starts_with("warning: dfs-12-1: the sensor `"),
        "{stderr}"
    );
    let report = fs::read_to_string(folder.path().join("found/report.md")).unwrap();
    assert!(
        report.contains("`reward.step_threshold` = 176 (from the maze)"),
        "{report}"
    );
    let paper = path("paper");
    let few = ["--trials", "1", "--episodes", "1"];
    expect(0, &[&run[..], &["paper"], &few, &out, &[&paper]].concat());
    let plan = fs::read_to_string(folder.path().join("paper/plan.json")).unwrap();
    let arms = |words: &str| plan.matches(words).count();
    assert_eq!(arms("\"step_threshold\": 60,"), 12);
    assert_eq!(arms("\"step_threshold_from_maze\": false"), 12);
}

#[test]
fn cells_that_look_alike_are_not_searched_for_in_vast_worlds_by_info_which_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("vast.json");
    let world = file.to_str().unwrap();
    let told = |size: &str| {
        let args = ["world", "generate", "--kind", "rooms", "--size", size];
        fs::write(&file, expect(0, &args).0).unwrap();
        let (text, _) = expect(0, &["world", "info", world]);
        let (described, _) = expect(0, &["world", "info", world, "--json"]);
        let unknown = json(described.as_bytes())["look_alike"].is_null();
        (text.contains("aliased     not searched"), unknown)
    };
    assert_eq!(told("129"), (true, true));
    // Control: the largest that are.
    assert_eq!(told("128"), (false, false));
}
