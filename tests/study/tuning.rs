//! `study tune`: which of the settings that a study varies are best.

use serde_json::Value;

use crate::desk::Desk;

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

fn desk() -> Desk {
    let desk = Desk::new();
    desk.write("sweep.toml", SWEEP);
    desk
}

fn search(desk: &Desk, name: &str) -> Value {
    serde_json::from_str(&desk.read(&format!("{name}/search.json"))).unwrap()
}

#[test]
fn a_search_halves_its_candidates_within_its_budget_and_ends_on_fresh_seeds() {
    let desk = desk();
    let said = desk.done("tune sweep.toml --budget 80 --out a --quiet");
    let found = search(&desk, "a");
    let first = &found["rungs"][0];
    let standings = first["standings"].as_array().unwrap();
    let names = standings
        .iter()
        .map(|one| one["candidate"].as_str().unwrap());
    let names: Vec<&str> = names.collect();
    assert_eq!(names.len(), 4, "{found:#}");
    // Half of the budget for four candidates.
    assert_eq!(first["seeds"], 10);
    assert!(names[0].contains("xcs.population_size=1600"), "{found:#}");
    assert!(names[3].contains("xcs.population_size=32"), "{found:#}");
    assert!(found["spent"].as_u64() <= Some(80), "{found:#}");
    let verdict = standings[3]["verdict"].as_str().unwrap();
    assert!(["worse", "halved"].contains(&verdict), "{found:#}");
    for words in ["rung 1, 10 more seeds", "On fresh seeds"] {
        assert!(said.contains(words), "{words}: {said}");
    }
    // The final, and each rung, have seeds of their own.
    let seed = |name: &str| {
        let plan = desk.read(&format!("a/{name}/study.json"));
        serde_json::from_str::<Value>(&plan).unwrap()["study"]["seed"].clone()
    };
    assert!(seed("final") != seed("rung-1") && seed("rung-1") != 1);
}

#[test]
fn a_search_in_tasks_that_wait_for_a_cluster_finds_the_same() {
    let desk = desk();
    let tune = "tune sweep.toml --budget 40 --quiet --out";
    desk.done(&format!("{tune} a"));
    assert!(
        desk.path("a/rung-2").exists(),
        "control: one rung shows nothing"
    );
    for stage in ["rung-1", "rung-2", "final"] {
        let waits = format!("study task b/{stage} I");
        desk.refused(&format!("{tune} b --tasks 3"), 75, &waits);
        for task in [3, 1, 2] {
            desk.done(&format!("task b/{stage} {task} --quiet"));
        }
    }
    desk.done(&format!("{tune} b --tasks 3"));
    assert_eq!(search(&desk, "a"), search(&desk, "b"));
    desk.assert_same("a/final/result", "b/final/result");
}

#[test]
fn what_cannot_be_searched_is_refused_with_the_way_out() {
    let desk = desk();
    let budget = "`budget` is 7, but must be from 8 to";
    desk.refused("tune sweep.toml --budget 7 --out a", 65, budget);
    desk.write("sweep.toml", SWEEP.split("[sweep]").next().unwrap());
    let one = "nothing to choose from";
    desk.refused("tune sweep.toml --budget 70 --out a", 65, one);
    assert!(!desk.path("a").exists());
}
