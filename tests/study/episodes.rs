//! The table of episodes of a study, and its learning curves.

use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::Path;

use crate::study::desk::{Desk, SMALL};

type Row = BTreeMap<String, String>;

/// The rows of the table of episodes, by column.
fn episode_rows(folder: &Path) -> Vec<Row> {
    let packed = fs::File::open(folder.join("episodes.csv.gz")).unwrap();
    rows(flate2::read::GzDecoder::new(packed))
}

fn rows(table: impl Read) -> Vec<Row> {
    let mut table = csv::Reader::from_reader(table);
    table.deserialize().map(|row| row.unwrap()).collect()
}

#[test]
fn a_repeat_that_differs_from_the_stored_result_is_an_error() {
    let desk = Desk::new();
    let file = SMALL.replace(r#"["xcs", "xcscr"]"#, r#"["q-learning"]"#);
    desk.write("one.toml", &file.replace("trials = 4", "trials = 1"));
    desk.done("run one.toml --out a --quiet");
    desk.done("episodes a");
    for name in ["episodes.csv.gz", "learning-curves.csv"] {
        fs::remove_file(desk.path("a").join(name)).unwrap();
    }
    // As another version of the program could have stored it.
    desk.edit_record("a", ("maze4", 1), |record| {
        let steps = &mut record["result"]["Ok"]["progress"]["steps"];
        *steps = (steps.as_u64().unwrap() + 1).into();
    });
    let words =
        "trial 1 of maze4 q-learning grid neighbours has another result when it is repeated";
    desk.refused("episodes a --force", 65, words);
    assert!(
        !desk.path("a/episodes.csv.gz").exists(),
        "nothing is written"
    );
    let best = desk.json("status a --json");
    assert_eq!(best["finished"], 2, "control: the journal is read");
}

/// The rows that have the same values as this one in some columns.
fn same<'a>(all: &'a [Row], one: &Row, keys: &[&str]) -> Vec<&'a Row> {
    let is_same = |row: &&Row| keys.iter().all(|key| row[*key] == one[*key]);
    all.iter().filter(is_same).collect()
}

#[test]
fn the_table_of_episodes_agrees_with_the_trials_and_does_not_depend_on_the_jobs() {
    let desk = Desk::new();
    desk.done("run small.toml --out a --quiet");
    desk.done("episodes a --jobs 1");
    let packed = || fs::read(desk.path("a/episodes.csv.gz")).unwrap();
    let first = packed();
    let rows = episode_rows(&desk.path("a"));
    assert_eq!(rows.len(), 2 * 2 * 4 * 12);
    for trial in self::rows(desk.read("a/trials.csv").as_bytes()) {
        let of_trial = same(&rows, &trial, &["world", "method", "trial", "seed"]);
        assert_eq!(of_trial.len(), 12);
        for key in ["steps", "collisions"] {
            let numbers = of_trial.iter().map(|row| row[key].parse::<u64>().unwrap());
            let sum = numbers.sum::<u64>().to_string();
            assert_eq!(sum, trial[key], "{key} of {trial:?}");
        }
        let first = of_trial.iter().find(|row| row["optimal"] == "true");
        let first = first.map_or(String::new(), |row| row["episode"].clone());
        assert_eq!(first, trial["first_optimal_episode"]);
        assert_eq!(of_trial[11]["optimal"], trial["retained"]);
    }
    // It is written anew only where that changes nothing, or by force.
    desk.done("episodes a --jobs 3");
    assert_eq!(packed(), first);
    desk.write("a/episodes.csv.gz", "mine");
    desk.refused("episodes a", 73, "--force");
    desk.done("episodes a --force --jobs 3");
    assert_eq!(packed(), first);
}

#[test]
fn learning_curves_are_the_means_of_the_table_of_episodes_and_stand_in_the_report() {
    let desk = Desk::new();
    desk.done("run small.toml --out a --quiet");
    desk.done("episodes a");
    let report = desk.read("a/report.md");
    assert!(report.contains("episodes.svg"), "{report}");
    let episodes = episode_rows(&desk.path("a"));
    let curves = desk.read("a/learning-curves.csv");
    let points = rows(curves.as_bytes());
    assert_eq!(points.len(), 2 * 2 * 12);
    for point in &points {
        let of_point = same(&episodes, point, &["world", "method", "episode"]);
        let steps = of_point.iter().map(|row| row["steps"].parse().unwrap());
        let steps: Vec<f64> = steps.collect();
        let mean = steps.iter().sum::<f64>() / steps.len() as f64;
        let squares: f64 = steps.iter().map(|step| (step - mean).powi(2)).sum();
        // Student's quantile for four trials.
        let margin = 3.182_446_305_284 * (squares / 3.0 / 4.0).sqrt();
        assert_eq!((steps.len(), point["trials"].as_str()), (4, "4"));
        for (key, expected) in [
            ("steps", mean),
            ("low", mean - margin),
            ("high", mean + margin),
        ] {
            let off = (point[key].parse::<f64>().unwrap() - expected).abs();
            assert!(off < 1e-5, "{key}: {point:?}, not {expected}");
        }
    }
    // A study in tasks gives the same files.
    desk.done("plan small.toml --tasks 2 --out split");
    for task in [2, 1] {
        desk.done(&format!("task split {task}"));
    }
    desk.done("report split");
    desk.done("episodes split");
    let files = "episodes.csv.gz learning-curves.csv episodes.svg report.md";
    for file in files.split(' ') {
        let [a, b] = ["a", "split"].map(|name| fs::read(desk.path(name).join(file)).unwrap());
        assert!(a == b, "{file} differs");
    }
    // Control: without the table there is no such figure, and a table of another study is none.
    desk.done("run small.toml --out c --quiet");
    assert!(!desk.path("c/episodes.svg").exists());
    desk.write("c/learning-curves.csv", &curves.replace("maze5", "maze6"));
    desk.done("report c --force");
    assert!(!desk.path("c/episodes.svg").exists());
}

#[test]
fn each_value_of_a_sweep_is_tested_against_the_first_where_nothing_else_differs() {
    let desk = Desk::new();
    let small = SMALL.replace(r#", "xcscr"]"#, "]");
    let small = small.replace(r#", "maze5"]"#, "]") + "[sweep]\n\"xcs.beta\" = [0.1, 0.2, 0.3]\n";
    desk.write("sweep.toml", &(small + "\"xcs.mu\" = [0.1, 0.2]\n"));
    let report = desk.done("run sweep.toml --out a --quiet");
    let json = desk.json("report a --json");
    let comparisons = json["comparisons"].as_array().unwrap();
    let words = |one: &serde_json::Value| {
        let word = |key: &str| one[key].as_str().unwrap().to_owned();
        format!(
            "{} - {}, {}",
            word("method"),
            word("against"),
            word("setting")
        )
    };
    let found: Vec<String> = comparisons.iter().map(words).collect();
    let mut expected = Vec::new();
    for beta in ["0.1", "0.2", "0.3"] {
        for mu in ["0.1", "0.2"] {
            if beta != "0.1" {
                expected.push(format!(
                    "xcs xcs.beta={beta} - xcs.beta=0.1, grid, neighbours xcs.mu={mu}"
                ));
            }
            if mu != "0.1" {
                expected.push(format!(
                    "xcs xcs.mu={mu} - xcs.mu=0.1, grid, neighbours xcs.beta={beta}"
                ));
            }
        }
    }
    assert_eq!(found, expected, "{report}");
    assert!(
        report.contains("The tests of 4 pairs, corrected for 7 comparisons,"),
        "{report}"
    );
}

#[test]
fn no_comparison_is_of_arms_that_differ_in_two_things() {
    let desk = Desk::new();
    let more = "without = [\"xcs.ga\"]\n[sweep]\n\"xcs.beta\" = [0.1, 0.2]\n\"xcs.action_set_subsumption\" = [true, false]\n";
    desk.write(
        "both.toml",
        &(SMALL.replace("trials = 4", "trials = 2") + more),
    );
    desk.done("run both.toml --out a --quiet --episodes 2");
    let json = desk.json("report a --json");
    let comparisons = json["comparisons"].as_array().unwrap();
    for comparison in comparisons {
        let [method, against, setting] =
            ["method", "against", "setting"].map(|key| comparison[key].as_str().unwrap());
        let varied = |text: &str| text.matches(['=', ' ']).count();
        let (ours, theirs) = (
            method.split_once(' ').map_or("", |(_, value)| value),
            against,
        );
        let key = |value: &str| {
            value
                .split(['=', ' '])
                .next()
                .unwrap_or_default()
                .to_owned()
        };
        let is_of_methods = ours.is_empty();
        assert!(
            is_of_methods || key(ours) == key(theirs),
            "{method} - {against}, {setting}"
        );
        assert!(varied(theirs) <= 1, "{method} - {against}, {setting}");
        assert!(
            is_of_methods || !setting.contains(&format!("{}=", key(ours))),
            "{method} - {against}, {setting}"
        );
    }
    // In two worlds: 8 of methods; for each of two methods 4 without the GA, 4 of beta and 4 of subsumption.
    assert_eq!(comparisons.len(), 2 * (8 + 2 * (4 + 4 + 4)));
}

#[test]
fn a_table_of_a_sweep_without_a_setting_is_shown_with_the_value_of_the_study() {
    let desk = Desk::new();
    let more = "sweep = [{}, { \"xcs.mu\" = [0.1] }]\n[settings]\nxcs.mu = 0.025\n";
    let text = SMALL.replace("trials = 4", "trials = 2");
    desk.write("two.toml", &(text + more));
    desk.done("run two.toml --out two --quiet --episodes 2");
    let report = desk.done("report two");
    assert!(report.contains("xcs.mu=0.025"), "{report}");
    assert!(!report.contains("xcs.mu=default"), "{report}");
}
