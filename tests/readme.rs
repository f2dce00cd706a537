//! The README's table of the preset `paper` is that of `assets/results/paper.json`, which is the
//! `summary.json` of `xcscr study run paper`.

use std::fs;
use std::path::Path;

use serde_json::Value;

const METHODS: [(&str, [u32; 3]); 4] = [
    ("xcs", [7, 2, 0]),
    ("adapted-even", [77, 29, 25]),
    ("adapted-discounted", [77, 29, 25]),
    ("xcscr", [79, 54, 65]),
];

fn text(name: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(name)).unwrap()
}

fn percent(share: &Value) -> String {
    share
        .as_f64()
        .map_or("–".to_owned(), |share| format!("{:.0} %", 100.0 * share))
}

/// Found with its interval, kept to the end, and the share of the episodes held.
fn cell(arm: &Value) -> String {
    let bound = |name: &str| (100.0 * arm[name].as_f64().unwrap()).round();
    format!(
        "{} [{}-{}], {}, {}",
        arm["successes"],
        bound("wilson_low"),
        bound("wilson_high"),
        arm["retained"],
        percent(&arm["mean_optimal_share_after_first"])
    )
}

#[test]
fn the_table_of_the_paper_is_that_of_the_results() {
    let summary: Value = serde_json::from_str(&text("assets/results/paper.json")).unwrap();
    let readme = text("README.md");
    for (method, paper) in METHODS {
        let arms = summary["arms"].as_array().unwrap().iter();
        let cells = arms.filter(|arm| arm["method"] == method).map(cell);
        let cells = cells
            .zip(paper)
            .map(|(ours, paper)| format!(" {ours} | {paper} |"));
        let row = format!("| `{method}` |{}", cells.collect::<String>());
        assert!(readme.contains(&row), "the README lacks\n{row}");
    }
}

#[test]
fn the_results_are_those_of_the_preset() {
    let preset = text("src/study/protocol/presets/paper.toml");
    let summary: Value = serde_json::from_str(&text("assets/results/paper.json")).unwrap();
    for key in ["seed", "episodes"] {
        assert!(
            preset.contains(&format!("{key} = {}\n", summary[key])),
            "{key}"
        );
    }
}
