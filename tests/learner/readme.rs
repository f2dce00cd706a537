//! What the pages say about the paper's methods follows from `assets/results/`: each file there is
//! the `summary.json` of a study, `paper.json` and `ablation.json` of the presets with these names at commit 8ff3eb65,
//! `paper-physics.json` of `xcscr study run paper --arena physics`, the others of the study files that
//! lie beside them.

use std::fs;
use std::path::Path;

use serde_json::Value;

fn text(name: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(name)).unwrap()
}

/// The pages about the published methods have these words, in one line or two.
#[track_caller]
fn assert_told(words: &str) {
    let pages = text("docs/src/results/replication.md") + &text("docs/src/results/baselines.md");
    let is_told = pages.replace('\n', " ").contains(words);
    assert!(is_told, "the pages lack {words}");
}

fn results(name: &str) -> Value {
    serde_json::from_str(&text(&format!("assets/results/{name}.json"))).unwrap()
}

fn arms(summary: &Value) -> &Vec<Value> {
    summary["arms"].as_array().unwrap()
}

#[test]
fn the_results_are_those_of_the_preset() {
    let preset = text("src/study/protocol/presets/paper.toml");
    let summary = results("paper");
    for key in ["seed", "episodes"] {
        assert!(
            preset.contains(&format!("{key} = {}\n", summary[key])),
            "{key}"
        );
    }
}

#[test]
fn in_physics_the_paper_s_numbers_are_the_same() {
    let figures = |name: &str| {
        let summary = results(name);
        let of = |arm: &Value| {
            let keys = ["world", "method", "successes", "retained", "iqm_env_steps"];
            keys.map(|key| arm[key].clone())
        };
        arms(&summary).iter().map(of).collect::<Vec<_>>()
    };
    assert_eq!(figures("paper"), figures("paper-physics"));
    assert_told("With `--arena physics` the twelve numbers, and the steps, are the same");
}

#[test]
fn what_the_pages_say_of_xcsam_is_in_the_results() {
    let summary = results("paper-xcsam");
    let found = arms(&summary)
        .iter()
        .map(|arm| arm["successes"].to_string());
    let found: Vec<String> = found.collect();
    assert_told(&format!("settings in {} of 100 trials", found.join(", ")));
}

const MECHANISMS: [&str; 4] = [
    "imprinting",
    "learning_rate_switching",
    "short_term_filter",
    "learning_step_threshold",
];

fn has(arm: &Value, mechanism: &str) -> bool {
    let variant = arm["variant"].as_str().unwrap();
    variant.contains(&format!("reward.{mechanism}=true"))
}

/// By mechanism, the points that it adds in a maze on average over all combinations of the others, and
/// when it is added last.
fn effects(summary: &Value, world: &str) -> [(f64, f64); 4] {
    let arms: Vec<&Value> = arms(summary)
        .iter()
        .filter(|arm| arm["world"] == world)
        .collect();
    let points = |is_wanted: &dyn Fn(&Value) -> bool| {
        let wanted = arms.iter().filter(|arm| is_wanted(arm));
        wanted
            .map(|arm| arm["successes"].as_f64().unwrap())
            .sum::<f64>()
    };
    let full = points(&|arm| MECHANISMS.iter().all(|name| has(arm, name)));
    MECHANISMS.map(|name| {
        let [on, off] = [true, false].map(|on| points(&|arm| has(arm, name) == on));
        let is_other = |arm: &Value, other: &str| has(arm, other) == (other != name);
        let without = points(&|arm| MECHANISMS.iter().all(|other| is_other(arm, other)));
        ((on - off) / 8.0, full - without)
    })
}

#[test]
fn what_the_mechanisms_contribute_is_in_the_results() {
    let summary = results("ablation");
    assert_eq!(arms(&summary).len(), 48);
    let by_maze = ["maze4", "maze5", "maze6"].map(|maze| effects(&summary, maze));
    let span = |figures: Vec<f64>| {
        let low = figures.iter().copied().fold(f64::MAX, f64::min).round();
        let high = figures.iter().copied().fold(f64::MIN, f64::max).round();
        format!("{low:.0} to {high:.0}")
    };
    let added = by_maze.iter().flat_map(|maze| &maze[..3]);
    let added = span(added.map(|effect| effect.0).collect());
    let last = by_maze[1..].iter().flat_map(|maze| &maze[..3]);
    let last = span(last.map(|effect| effect.1).collect());
    assert_told(&format!("short-term filter add {added} points each"));
    assert_told(&format!("is still worth {last} points in Maze5 and Maze6"));
    assert!(by_maze.iter().all(|maze| maze[3].0.abs() < 2.0));
}

/// A row of the front page: solved trials, and the interquartile mean of the steps, in Maze6.
fn front_row(name: &str, method: &str, file: &str) -> String {
    let summary = results(file);
    let arm = arms(&summary)
        .iter()
        .find(|arm| arm["method"] == method && arm["world"] == "maze6")
        .unwrap();
    let steps = arm["iqm_env_steps"].as_f64().unwrap();
    format!("| {name} | {} | {steps:.0} |", arm["successes"])
}

#[test]
fn the_table_of_the_front_page_is_that_of_the_results() {
    let readme = text("README.md");
    for method in ["xcs", "xcscr", "q-learning", "r-max", "xcscr-plus"] {
        let row = front_row(&format!("`{method}`"), method, "defaults");
        assert!(readme.contains(&row), "the README lacks\n{row}");
    }
    let row = front_row("`r-max` without generalisation", "r-max", "r-max-bare");
    assert!(readme.contains(&row), "the README lacks\n{row}");
}

#[test]
fn every_file_that_the_readme_names_exists() {
    let (root, readme) = (Path::new(env!("CARGO_MANIFEST_DIR")), text("README.md"));
    let folders = ["tests/", "src/", "examples/", "crates/"];
    let named = readme.split('`');
    let named = named.filter(|word| folders.iter().any(|folder| word.starts_with(folder)));
    let named: Vec<&str> = named.filter(|word| !word.contains([' ', '\n'])).collect();
    assert!(!named.is_empty());
    for file in named {
        assert!(root.join(file).exists(), "README.md names {file}");
    }
}
