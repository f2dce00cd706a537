//! What the pages say about the paper's methods follows from `assets/results/`: each file there is
//! the `summary.json` of a study, written by `assets/results/measure`.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde_json::Value;
use xcscr::agent::Method;
use xcscr::trial::Settings;

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

/// The defaults of a method, by key.
fn defaults(method: Method) -> BTreeMap<String, Value> {
    let sections = serde_json::to_value(Settings::of(method)).unwrap();
    let keyed = |(section, values): (&String, &Value)| {
        let values = values.as_object().unwrap().clone().into_iter();
        let section = section.clone();
        values.map(move |(key, value)| (format!("{section}.{key}"), value))
    };
    sections
        .as_object()
        .unwrap()
        .iter()
        .flat_map(keyed)
        .collect()
}

/// The keys of settings in which some methods of the paper differ.
fn differing() -> Vec<String> {
    let first = defaults(Method::Xcs);
    let others = [
        Method::AdaptedEven,
        Method::AdaptedDiscounted,
        Method::Xcscr,
    ]
    .map(defaults);
    let differs = |(key, value): &(&String, &Value)| others.iter().any(|o| o[*key] != **value);
    first
        .iter()
        .filter(differs)
        .map(|(key, _)| key.clone())
        .collect()
}

#[test]
fn the_study_of_the_paper_sets_what_differs_between_its_methods_and_the_page_shows_it() {
    let preset = text("src/study/protocol/presets/paper.toml");
    let (_, settings) = preset.split_once("[settings]\n").unwrap();
    let differing = differing();
    assert!(differing.len() > 5, "control: the defaults differ");
    for key in differing {
        let is_set = settings.contains(&format!("\"{key}\" = "));
        assert!(is_set, "{key} depends on the method");
    }
    let page = text("docs/src/results/replication.md");
    let missing: Vec<&str> = settings
        .lines()
        .filter(|line| !page.contains(line))
        .collect();
    assert!(missing.is_empty(), "the page lacks {missing:?}");
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

/// The figures of a table of the front page, in Maze4, Maze5 and Maze6.
fn in_three_mazes(arms: &[&Value], key: &str) -> String {
    let figure = |arm: &&Value| format!("{:.0}", arm[key].as_f64().unwrap());
    arms.iter().map(figure).collect::<Vec<_>>().join(", ")
}

/// The end of a row about a method: solved, retained, steps, contacts.
fn method_row(method: &str, file: &str) -> String {
    let summary = results(file);
    let all = arms(&summary).iter();
    let all: Vec<&Value> = all.filter(|arm| arm["method"] == method).collect();
    let keys = ["successes", "retained", "iqm_env_steps", "mean_collisions"];
    let cells = keys.map(|key| in_three_mazes(&all, key));
    format!("| {} |", cells.join(" | "))
}

/// The end of a row about a mechanism: retained, steps, contacts.
fn mechanism_row(left_out: &str) -> String {
    let summary = results("mechanisms");
    let variant = format!("without={left_out}");
    let all = arms(&summary).iter();
    let all: Vec<&Value> = all.filter(|arm| arm["variant"] == *variant).collect();
    let keys = ["retained", "iqm_env_steps", "mean_collisions"];
    let cells = keys.map(|key| in_three_mazes(&all, key));
    format!("| {} |", cells.join(" | "))
}

#[test]
fn the_tables_of_the_front_page_are_those_of_the_results() {
    let readme = text("README.md");
    let methods = [
        "xcs",
        "adapted-discounted",
        "xcscr",
        "q-learning",
        "r-max",
        "xcscr-plus",
    ];
    for method in methods {
        let row = format!("| `{method}` {}", method_row(method, "defaults"));
        assert!(readme.contains(&row), "the README lacks\n{row}");
    }
    let row = method_row("q-learning", "tuned");
    assert!(readme.contains(&row), "the README lacks\n{row}");
    let mechanisms = [
        "nothing",
        "reward.short_term_filter",
        "reward.imprinting",
        "reward.learning_rate_switching",
        "reward.learning_step_threshold",
        "reward.loop_erasure",
    ];
    for row in mechanisms.map(mechanism_row) {
        assert!(readme.contains(&row), "the README lacks\n{row}");
    }
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
