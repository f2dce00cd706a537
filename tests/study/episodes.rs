//! The table of episodes of a study, and its learning curves.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::desk::Desk;

/// The rows of the table of episodes, by column.
fn episode_rows(folder: &Path) -> Vec<BTreeMap<String, String>> {
    let packed = fs::File::open(folder.join("episodes.csv.gz")).unwrap();
    let mut table = csv::Reader::from_reader(flate2::read::GzDecoder::new(packed));
    table.deserialize().map(|row| row.unwrap()).collect()
}

#[test]
fn the_table_of_episodes_agrees_with_the_trials_and_does_not_depend_on_the_jobs() {
    let desk = Desk::new();
    desk.done("run small.toml --out a --jobs 1 --quiet");
    desk.done("run small.toml --out b --jobs 2 --quiet");
    desk.done("episodes a --jobs 1");
    desk.done("episodes b --jobs 3");
    let packed = |name: &str| fs::read(desk.path(name).join("episodes.csv.gz")).unwrap();
    assert_eq!(packed("a"), packed("b"));
    let rows = episode_rows(&desk.path("a"));
    assert_eq!(rows.len(), 2 * 2 * 4 * 12);
    let mut trials = csv::Reader::from_path(desk.path("a/trials.csv")).unwrap();
    for trial in trials.deserialize() {
        let trial: BTreeMap<String, String> = trial.unwrap();
        let same = |row: &&BTreeMap<String, String>| {
            ["world", "method", "trial", "seed"]
                .iter()
                .all(|key| row[*key] == trial[*key])
        };
        let of_trial: Vec<_> = rows.iter().filter(same).collect();
        let sum = |key: &str| {
            of_trial
                .iter()
                .map(|row| row[key].parse::<u64>().unwrap())
                .sum::<u64>()
        };
        assert_eq!(of_trial.len(), 12);
        for key in ["steps", "collisions"] {
            assert_eq!(sum(key).to_string(), trial[key], "{key} of {trial:?}");
        }
        let first = of_trial.iter().find(|row| row["optimal"] == "true");
        let first = first.map_or(String::new(), |row| row["episode"].clone());
        assert_eq!(first, trial["first_optimal_episode"]);
        assert_eq!(of_trial[11]["optimal"], trial["retained"]);
    }
    // It is written anew only where that changes nothing, or by force.
    desk.done("episodes a");
    desk.write("a/episodes.csv.gz", "mine");
    let message = desk.refused("episodes a", 73);
    assert!(message.contains("--force"), "{message}");
    desk.done("episodes a --force");
    assert_eq!(packed("a"), packed("b"));
}

#[test]
fn learning_curves_are_the_means_of_the_table_of_episodes_and_stand_in_the_report() {
    let desk = Desk::new();
    let report = desk.done("run small.toml --out a --quiet --episodes-csv");
    assert!(report.contains("episodes.svg"), "{report}");
    let rows = episode_rows(&desk.path("a"));
    let mut curves = csv::Reader::from_path(desk.path("a/learning-curves.csv")).unwrap();
    let points: Vec<BTreeMap<String, String>> = curves.deserialize().map(Result::unwrap).collect();
    assert_eq!(points.len(), 2 * 2 * 12);
    for point in &points {
        let same = |row: &&BTreeMap<String, String>| {
            ["world", "method", "episode"]
                .iter()
                .all(|key| row[*key] == point[*key])
        };
        let of_point = rows.iter().filter(same);
        let steps: Vec<f64> = of_point.map(|row| row["steps"].parse().unwrap()).collect();
        let mean = steps.iter().sum::<f64>() / steps.len() as f64;
        let squares: f64 = steps.iter().map(|step| (step - mean).powi(2)).sum();
        let margin = 1.96 * (squares / 3.0 / 4.0).sqrt();
        let number = |key: &str| point[key].parse::<f64>().unwrap();
        assert_eq!((steps.len(), point["trials"].as_str()), (4, "4"));
        for (key, expected) in [
            ("steps", mean),
            ("low", mean - margin),
            ("high", mean + margin),
        ] {
            assert!(
                (number(key) - expected).abs() < 1e-5,
                "{key}: {point:?}, not {expected}"
            );
        }
    }
    // Shards that are merged give the same files.
    for shard in ["1/2", "2/2"] {
        desk.study(&format!(
            "run small.toml --out b{} --quiet --shard {shard}",
            &shard[..1]
        ));
    }
    desk.done("merge b1 b2 --out b --episodes-csv");
    for file in [
        "episodes.csv.gz",
        "learning-curves.csv",
        "episodes.svg",
        "report.md",
    ] {
        let [a, b] = ["a", "b"].map(|name| fs::read(desk.path(name).join(file)).unwrap());
        assert!(a == b, "{file} differs");
    }
    // Control: without the table there is no such figure, and a table of another study is none.
    desk.done("run small.toml --out c --quiet");
    assert!(!desk.path("c/episodes.svg").exists());
    let text = fs::read_to_string(desk.path("a/learning-curves.csv")).unwrap();
    desk.write("c/learning-curves.csv", &text.replace("maze5", "maze6"));
    desk.done("report c --force");
    assert!(!desk.path("c/episodes.svg").exists());
}

#[test]
fn a_sweep_of_two_settings_has_a_heat_map_and_tests_against_its_first_values() {
    let desk = Desk::new();
    let small = fs::read_to_string(desk.path("small.toml")).unwrap();
    let small = small
        .replace(r#", "xcscr"]"#, "]")
        .replace(r#", "maze5"]"#, "]");
    let sweep = "[sweep]\n\"xcs.beta\" = [0.1, 0.2, 0.3]\n\"xcs.mu\" = [0.1, 0.2]\n";
    desk.write("sweep.toml", &(small.clone() + sweep));
    let report = desk.done("run sweep.toml --out a --quiet");
    let map = fs::read_to_string(desk.path("a/heat.svg")).unwrap();
    let shares = map.matches(" %").count();
    assert_eq!(shares, 6, "a share in each of 3 x 2 cells");
    for value in ["xcs.beta", "xcs.mu", "0.3"] {
        assert!(map.contains(value), "{value} is not in the map");
    }
    let json: serde_json::Value = serde_json::from_str(&desk.done("report a --json")).unwrap();
    let comparisons = json["comparisons"].as_array().unwrap();
    assert_eq!(comparisons.len(), 5, "{report}");
    let against = comparisons
        .iter()
        .map(|one| one["against"].as_str().unwrap());
    assert!(
        against
            .into_iter()
            .all(|against| against == "xcs.beta=0.1 xcs.mu=0.1")
    );
    assert!(report.contains("4 trials of each detect"), "{report}");
    // Control: one setting makes no map.
    desk.write(
        "one.toml",
        &(small + "[sweep]\n\"xcs.beta\" = [0.1, 0.2]\n"),
    );
    desk.done("run one.toml --out b --quiet");
    assert!(!desk.path("b/heat.svg").exists());
}
