//! Rules to be read, compacted, and carried from maze to maze, by the commands of the program.

use std::fs;
use std::path::Path;
use std::sync::OnceLock;

use tempfile::TempDir;
use xcscr::agent::Knowledge;
use xcscr::sensor::Sensor;
use xcscr::world::Maze;

use crate::kit::program::{ended, xcscr};

/// Runs in Maze4 that all tests look at, and how they are trained.
const RUNS: [(&str, &str); 5] = [
    ("plus", "--method xcscr-plus"),
    ("r-max", "--method r-max"),
    ("xcscr", "--method xcscr"),
    ("xcs", "--method xcs"),
    ("q-learning", "--method q-learning"),
];

/// Words that train without recordings.
const TRAIN: &str = "--arena grid --sensor neighbours --record none --quiet --out";

/// Returns the folder of the runs, in which tests make files of other names.
fn desk() -> &'static Path {
    static DESK: OnceLock<TempDir> = OnceLock::new();
    let made = || {
        let folder = tempfile::tempdir().unwrap();
        for (name, how) in RUNS {
            let words = format!("train {} {how} {TRAIN} {name}", world("maze4"));
            ends(folder.path(), &words, 0);
        }
        folder
    };
    DESK.get_or_init(made).path()
}

/// Runs a command of these words in a folder, which must end with `code`. Returns stdout and stderr.
#[track_caller]
fn ends(folder: &Path, words: &str, code: i32) -> (String, String) {
    let mut command = xcscr(&words.split(' ').collect::<Vec<_>>());
    let output = command.current_dir(folder).output().unwrap();
    ended(&output, code, words)
}

/// Returns what a command prints that succeeds.
#[track_caller]
fn fine(words: &str) -> String {
    ends(desk(), words, 0).0
}

/// Runs a command that must end with this code and message, and print nothing else.
#[track_caller]
fn refused(words: &str, code: i32, message: &str) {
    let (stdout, stderr) = ends(desk(), words, code);
    assert!(stdout.is_empty(), "{words}: {stdout}");
    assert!(stderr.contains(message), "{words}: {stderr}");
}

fn world(name: &str) -> String {
    format!("{}/worlds/{name}.json", env!("CARGO_MANIFEST_DIR"))
}

fn keep(name: &str, text: &str) {
    fs::write(desk().join(name), text).unwrap();
}

/// How many rules a JSON document lists.
fn count(text: &str) -> usize {
    text.matches("\"numerosity\"").count()
}

#[test]
fn the_fewest_rules_are_printed_and_drive_the_robot_like_all_rules() {
    let maze4 = world("maze4");
    for (run, most) in [("plus", 15), ("xcscr", 30)] {
        let text = fine(&format!("rules {run}"));
        assert!(
            text.contains("rules are enough for all decisions"),
            "{text}"
        );
        let few = fine(&format!("rules {run} --json"));
        let all = fine(&format!("rules {run} --all --json"));
        let (few_rules, all_rules) = (count(&few), count(&all));
        let is_so = few_rules <= most && all_rules > 5 * few_rules;
        assert!(is_so, "{run}: {few_rules} of {all_rules}");
        for (name, rules) in [("few.json", &few), ("all.json", &all)] {
            keep(name, rules);
            if run == "plus" {
                fine(&format!(
                    "evaluate {name} --world {maze4} --sensor neighbours --arena grid --require-optimal"
                ));
            }
        }
    }
}

#[test]
fn rules_are_listed_by_coverage_and_no_rules_are_a_table_too() {
    let text = fine("rules plus --all --csv");
    let mut table = csv::Reader::from_reader(text.as_bytes());
    let heads = table.headers().unwrap().clone();
    let covers = heads.iter().position(|one| one == "covers").unwrap();
    let rows = table.records().map(Result::unwrap);
    let covers: Vec<u32> = rows.map(|row| row[covers].parse().unwrap()).collect();
    let is_sorted = covers.is_sorted_by(|a, b| a >= b);
    assert!(is_sorted && covers[0] > covers[covers.len() - 1], "{text}");
    keep("none.json", r#"{"rules": []}"#);
    let maze4 = world("maze4");
    let none = fine(&format!(
        "rules none.json --world {maze4} --csv --sensor neighbours"
    ));
    assert!(none.lines().eq(text.lines().take(1)), "{none}");
}

#[test]
fn in_another_world_the_fewest_rules_decide_wherever_all_rules_do() {
    let own = fine("rules plus --json");
    assert!(own.contains("\"known\""), "control: {own}");
    let maze = Maze::load(world("maze5").as_ref()).unwrap();
    for source in ["plus", "plus/rules.json"] {
        let at = format!("{source} --world {} --sensor neighbours", world("maze5"));
        let [few, all] = ["", "--all "].map(|how| {
            let text = fine(&format!("rules {at} {how}--json"));
            serde_json::from_str::<Knowledge>(&text).unwrap()
        });
        let mut decided = 0;
        for percept in Sensor::Neighbours.percepts(&maze) {
            let [few, all] = [&few, &all].map(|rules| rules.values(&percept, 4));
            let mut chosen = few.best_actions();
            assert!(chosen.all(|action| all.is_nearly_best(action)), "{percept}");
            assert_eq!(few.greatest().is_some(), all.greatest().is_some());
            decided += usize::from(all.greatest().is_some());
        }
        let (of_few, of_all) = (few.len(), all.len());
        assert!(of_few < of_all && decided > 10, "{of_few}, {decided}");
        let csv = fine(&format!("export {at} --target csv"));
        assert_eq!(csv.lines().count() - 1, of_few, "{source}");
    }
}

#[test]
fn what_has_no_rules_or_no_percept_is_refused() {
    for (words, code, message) in [
        ("rules q-learning", 65, "table"),
        ("rules r-max", 65, "it has no rules"),
        ("rules plus --why 0,0", 2, "there is no free cell 0,0"),
        ("rules plus --why 6,6", 2, "6,6 is a goal"),
        ("rules plus --json --csv", 2, "--csv"),
    ] {
        refused(words, code, message);
    }
}

#[test]
fn collision_rules_from_one_maze_spare_collisions_in_the_next() {
    let [fresh, brought] = [("fresh", ""), ("brought", " --init-rules plus")].map(|(out, more)| {
        let how = format!("{} {}{more} --json", world("maze5"), RUNS[0].1);
        let text = fine(&format!("train {how} {TRAIN} {out}"));
        let report: serde_json::Value = serde_json::from_str(&text).unwrap();
        ["collisions", "first_optimal_env_steps"].map(|key| report[key].as_u64().unwrap())
    });
    // Rules without a correction collide, too: what the model predicts does not choose for them.
    assert!(fresh[0] > 4 * brought[0], "{fresh:?} {brought:?}");
    assert!(brought[1] < fresh[1], "{fresh:?} {brought:?}");
}

#[test]
fn a_run_that_began_with_rules_is_repeated_from_its_recording() {
    let how =
        "--method xcscr-plus --sensor neighbours --episodes 3 --quiet --init-rules plus/rules.json";
    fine(&format!("train {} {how} --out begun", world("maze6")));
    let text = fine("recording verify begun");
    let said = "4 of 4 recordings are bit-identical";
    assert!(text.contains(said), "three episodes and the run: {text}");
}

#[test]
fn rules_that_a_method_cannot_begin_with_are_refused_before_anything_is_written() {
    let begin = |method: &str, run: &str| {
        let maze = world("maze5");
        format!("train {maze} --method {method} --init-rules {run} {TRAIN} refused")
    };
    for method in ["xcscr-plus", "q-learning"] {
        refused(&begin(method, "xcs"), 65, &format!("`{method}`"));
        assert!(!desk().join("refused").exists(), "{method}");
    }
    fine(&begin("xcscr", "xcs").replace("refused", "control"));
}

#[test]
fn why_tells_which_rules_match_and_their_shares() {
    let told = fine("rules plus --why 1,1");
    assert!(told.starts_with("maze4, neighbours, cell 1,1\n"), "{told}");
    for words in [
        "perceives   north wall, north-east wall, east free",
        "goes        east   (values: east ",
    ] {
        assert!(told.contains(words), "{words}: {told}");
    }
    // A lone file of rules has the same votes.
    let maze4 = world("maze4");
    let lone = format!("rules plus/rules.json --world {maze4} --sensor neighbours --why 1,1");
    assert_eq!(told, fine(&lone));
}

/// Does a text name a column or row by a pattern of bits?
fn has_pattern(text: &str) -> bool {
    ["column ", "row "].iter().any(|name| {
        text.split(name).skip(1).any(|rest| {
            let word: String = rest.chars().take_while(|c| "01#".contains(*c)).collect();
            word.contains('#') || word.len() > 2
        })
    })
}

#[test]
fn rules_over_a_position_are_told_as_ranges_by_rules_why_and_export() {
    assert!(has_pattern("if column ##1# then") && has_pattern("row 0110"));
    assert!(!has_pattern("column at most 3 or 10, row 11"), "control");
    let maze4 = world("maze4");
    for (sensor, arena) in [
        ("position", "grid"),
        ("neighbours-position", "grid"),
        ("lidar-position", "physics"),
    ] {
        let how = format!(
            "--sensor {sensor} --arena {arena} --method xcs --set xcs.dont_care=0.3 --record none"
        );
        fine(&format!("train {maze4} --episodes 10 --out {sensor} {how}"));
        let rules = fine(&format!("rules {sensor} --all"));
        let why = fine(&format!("rules {sensor} --why 1,1"));
        let mut told = vec![fine(&format!("rules {sensor} --json"))];
        // Of all rules, values may lie too close to be told apart in whole numbers.
        let few = format!("{sensor}.json");
        keep(&few, &fine(&format!("rules {sensor} --json")));
        for target in ["c99", "python", "csv", "json"] {
            let export = format!("export {few} --world {maze4} --sensor {sensor}");
            told.push(fine(&format!("{export} --target {target}")));
        }
        for text in told.iter().chain([&rules, &why]) {
            assert!(!has_pattern(text), "{sensor}: {text}");
        }
        for words in ["column at most 3", "row at least 4", "column 2 to 3"] {
            assert!(rules.contains(words), "{sensor}: {words}: {rules}");
        }
        assert!(why.contains("column 1, row 1"), "{sensor}: {why}");
    }
}

#[test]
fn export_writes_a_file_once_says_where_it_comes_from_and_prints_data() {
    fine("export plus --target c99 -o policy.h");
    let read = || fs::read_to_string(desk().join("policy.h")).unwrap();
    let text = read();
    for fact in [
        "World maze4",
        "xcscr-plus with seed 1",
        "CRC-32 of the rules: ",
    ] {
        assert!(text.contains(fact), "{fact}: {text}");
    }
    ends(desk(), "export plus --target python -o policy.h", 73);
    assert_eq!(read(), text, "nothing is overwritten");
    fine("export plus --target python -o policy.h --force");
    assert_ne!(read(), text);
    let [csv, json] = ["csv", "json"].map(|target| fine(&format!("export plus --target {target}")));
    assert!(
        csv.starts_with("condition,action,weight,value,if,go\n"),
        "{csv}"
    );
    let rules = csv.lines().count() - 1;
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["origin"]["seed"], 1);
    assert_eq!(json["rules"].as_array().unwrap().len(), rules);
}
