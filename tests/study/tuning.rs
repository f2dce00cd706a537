//! `study tune`: which of the settings that a study varies are best.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

use crate::kit::{folder, program};

/// Settings of which some cannot learn: there is no room for the rules that are needed.
const SWEEP: &str = r#"
name = "sweep"
worlds = ["maze4"]
methods = ["xcscr"]
trials = 3
episodes = 40

[sweep]
"xcs.population_size" = [32, 1600]
"xcs.theta_ga" = [5, 25]
"#;

fn tune(desk: &Path, words: &str) -> Output {
    let mut command: Command = program::xcscr(&[]);
    command
        .current_dir(desk)
        .args(["study", "tune", "sweep.toml"]);
    command.args(words.split(' ')).output().unwrap()
}

fn desk() -> tempfile::TempDir {
    let desk = tempfile::tempdir().unwrap();
    fs::write(desk.path().join("sweep.toml"), SWEEP).unwrap();
    desk
}

fn search(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("search.json")).unwrap()).unwrap()
}

#[test]
fn a_search_halves_its_candidates_within_its_budget_and_ends_on_fresh_seeds() {
    let desk = desk();
    let (said, _) = program::ended(&tune(desk.path(), "--budget 80 --out a --quiet"), 0, "a");
    let found = search(&desk.path().join("a"));
    let rungs = found["rungs"].as_array().unwrap();
    let names = |rung: &Value| -> Vec<String> {
        let standings = rung["standings"].as_array().unwrap().iter();
        standings
            .map(|one| one["candidate"].as_str().unwrap().to_owned())
            .collect()
    };
    assert_eq!(names(&rungs[0]).len(), 4, "{found:#}");
    assert_eq!(
        rungs[0]["seeds"], 10,
        "half of the budget for four candidates"
    );
    assert!(
        names(&rungs[0])[0].contains("xcs.population_size=1600"),
        "{found:#}"
    );
    assert!(
        names(&rungs[0])[3].contains("xcs.population_size=32"),
        "{found:#}"
    );
    assert!(found["spent"].as_u64() <= Some(80), "{found:#}");
    let lost = &rungs[0]["standings"][3];
    assert!(
        lost["verdict"] == "worse" || lost["verdict"] == "halved",
        "{found:#}"
    );
    assert!(
        said.contains("rung 1, 10 more seeds") && said.contains("On fresh seeds"),
        "{said}"
    );
    // The final, and each rung, have seeds of their own.
    let seeds = |name: &str| -> Value {
        let plan = fs::read(desk.path().join("a").join(name).join("plan.json")).unwrap();
        serde_json::from_slice::<Value>(&plan).unwrap()["study"]["seed"].clone()
    };
    assert!(seeds("final") != seeds("rung-1") && seeds("rung-1") != 1);
}

#[test]
fn a_search_in_tasks_that_wait_for_a_cluster_finds_the_same() {
    let desk = desk();
    let words = "--budget 40 --quiet --out";
    program::ended(&tune(desk.path(), &format!("{words} a")), 0, "a");
    for stage in ["rung-1", "rung-2", "final"] {
        let (_, said) = program::ended(
            &tune(desk.path(), &format!("{words} b --tasks 3")),
            75,
            stage,
        );
        assert!(said.contains(&format!("study task b/{stage} I")), "{said}");
        let planned = desk.path().join("b").join(stage);
        for task in ["3", "1", "2"] {
            let args = ["study", "task", planned.to_str().unwrap(), task, "--quiet"];
            program::expect(0, &args);
        }
        if !desk.path().join("a").join("rung-2").exists() && stage == "rung-1" {
            panic!("the search ended after one rung, so that nothing is shown here");
        }
    }
    program::ended(&tune(desk.path(), &format!("{words} b --tasks 3")), 0, "b");
    assert_eq!(
        search(&desk.path().join("a")),
        search(&desk.path().join("b"))
    );
    let result = |name: &str| desk.path().join(name).join("final/result");
    folder::assert_same(&result("a"), &result("b"), "the finals");
}

#[test]
fn what_cannot_be_searched_is_refused_with_the_way_out() {
    let desk = desk();
    let (_, said) = program::ended(&tune(desk.path(), "--budget 7 --out a"), 65, "budget");
    assert!(
        said.contains("`budget` is 7, but must be from 8 to"),
        "{said}"
    );
    fs::write(
        desk.path().join("sweep.toml"),
        SWEEP.split("[sweep]").next().unwrap(),
    )
    .unwrap();
    let (_, said) = program::ended(&tune(desk.path(), "--budget 70 --out a"), 65, "one");
    assert!(said.contains("nothing to choose from"), "{said}");
    assert!(!desk.path().join("a").exists());
}
