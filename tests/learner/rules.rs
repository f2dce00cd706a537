//! Rules to be read, compacted, and carried from maze to maze.

use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

/// A folder with a run of `xcscr-plus` in it.
struct Desk(TempDir);

impl Desk {
    fn new(method: &str) -> Self {
        let desk = Self(tempfile::tempdir().unwrap());
        desk.fine(&train(method, "maze4", "run"));
        desk
    }

    /// The same, with the cell on a map as the state from the first step.
    fn on_a_map() -> Self {
        let desk = Self(tempfile::tempdir().unwrap());
        let start = [
            "train",
            world("maze4"),
            "--arena",
            "grid",
            "--record",
            "none",
        ];
        desk.fine(&[&start[..], &["--quiet", "--out", "run"], &ON_A_MAP].concat());
        desk
    }

    fn xcscr(&self, args: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_xcscr"));
        command.current_dir(self.0.path()).args(args);
        command.output().unwrap()
    }

    /// What a command prints that ends well.
    fn fine(&self, args: &[&str]) -> String {
        let output = self.xcscr(args);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{args:?}: {stderr}");
        String::from_utf8(output.stdout).unwrap()
    }

    fn keep(&self, name: &str, text: &str) {
        std::fs::write(self.0.path().join(name), text).unwrap();
    }

    /// Code and message of a command that does not.
    fn refused(&self, args: &[&str]) -> (Option<i32>, String) {
        let output = self.xcscr(args);
        assert!(output.stdout.is_empty(), "{args:?}: {output:?}");
        (
            output.status.code(),
            String::from_utf8(output.stderr).unwrap(),
        )
    }
}

fn world(name: &str) -> &'static str {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("worlds/{name}.json"));
    Box::leak(path.to_str().unwrap().to_owned().into_boxed_str())
}

const ON_A_MAP: [&str; 4] = ["--set", "plus.estimator=map", "--sensor", "neighbours"];

/// With the percept as the state where there is a choice.
fn train<'a>(method: &'a str, maze: &str, out: &'a str) -> Vec<&'a str> {
    let start = ["train", world(maze), "--method", method, "--arena", "grid"];
    let end = ["--record", "none", "--quiet", "--out", out];
    let estimator = match method {
        "xcscr-plus" => &["--set", "plus.estimator=percept"][..],
        _ => &[],
    };
    [&start[..], &end, estimator].concat()
}

#[test]
fn condensed_rules_are_few_choose_the_same_everywhere_and_drive_the_robot() {
    let desk = Desk::new("xcscr-plus");
    let text = desk.fine(&["rules", "run", "--compact"]);
    assert!(
        text.contains("the same choice in 25 of the 25 percepts"),
        "{text}"
    );
    assert!(text.contains("the policy is globally optimal"), "{text}");
    let few = desk.fine(&["rules", "run", "--compact", "--json"]);
    let all = desk.fine(&["rules", "run", "--json"]);
    let (few_rules, all_rules) = (count(&few), count(&all));
    assert!(few_rules <= all_rules, "{few_rules} of {all_rules}");
    assert!(all_rules <= 15, "{all_rules} while it learns");
    desk.keep("few.json", &few);
    let drive = [
        "evaluate",
        "few.json",
        "--world",
        world("maze4"),
        "--require-optimal",
    ];
    desk.fine(&drive);
}

/// How many rules a JSON document lists.
fn count(text: &str) -> usize {
    text.matches("\"numerosity\"").count()
}

#[test]
fn the_many_rules_of_the_original_method_condense_to_few() {
    let desk = Desk::new("xcscr");
    let text = desk.fine(&["rules", "run", "--compact"]);
    assert!(
        text.contains("the same choice in 25 of the 25 percepts"),
        "{text}"
    );
    let few = count(&desk.fine(&["rules", "run", "--compact", "--json"]));
    let all = count(&desk.fine(&["rules", "run", "--json"]));
    assert!(few <= 15 && all > 2 * few, "{few} of {all}");
}

#[test]
fn a_cell_shows_the_rules_that_match_there_in_the_wanted_order() {
    let desk = Desk::new("xcscr");
    let csv = desk.fine(&["rules", "run", "--cell", "1,1", "--sort", "value", "--csv"]);
    let mut table = csv::Reader::from_reader(csv.as_bytes());
    let column = |name: &str| {
        let header = csv::Reader::from_reader(csv.as_bytes())
            .headers()
            .unwrap()
            .clone();
        header.iter().position(|one| one == name).unwrap()
    };
    let (go, value) = (column("go"), column("prediction"));
    let rows: Vec<_> = table.records().map(Result::unwrap).collect();
    let value: Vec<f64> = rows.iter().map(|row| row[value].parse().unwrap()).collect();
    assert!(
        value.is_sorted_by(|a, b| a >= b) && value.len() > 1,
        "{csv}"
    );
    // In Maze4 there is a wall on every side of the start but one.
    assert_eq!(&rows[0][go], "east", "{csv}");
    // No rules are a table, too.
    desk.keep("none.json", r#"{"rules": []}"#);
    let none = ["rules", "none.json", "--world", world("maze4"), "--csv"];
    let none = desk.fine(&[&none[..], &["--sensor", "neighbours"]].concat());
    assert_eq!(
        none.lines().collect::<Vec<_>>(),
        [csv.lines().next().unwrap()]
    );
}

#[test]
fn a_wall_has_no_percept_and_a_table_no_rules() {
    let desk = Desk::new("q-learning");
    let (code, message) = desk.refused(&["rules", "run"]);
    assert_eq!(code, Some(65), "{message}");
    assert!(message.contains("table"), "{message}");
    let desk = Desk::new("xcs");
    let (code, message) = desk.refused(&["rules", "run", "--cell", "0,0"]);
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("no free cell 0,0"), "{message}");
}

fn steps_to_optimum(report: &str) -> u64 {
    let report: serde_json::Value = serde_json::from_str(report).unwrap();
    report["first_optimal_env_steps"].as_u64().unwrap()
}

#[test]
fn foresight_from_one_maze_spares_collisions_in_the_next() {
    let desk = Desk::new("xcscr-plus");
    let fresh = desk.fine(&[&train("xcscr-plus", "maze5", "fresh")[..], &["--json"]].concat());
    let brought = ["--json", "--init-rules", "run"];
    let brought = desk.fine(&[&train("xcscr-plus", "maze5", "brought")[..], &brought].concat());
    let collisions = |text: &str| {
        let report: serde_json::Value = serde_json::from_str(text).unwrap();
        report["collisions"].as_u64().unwrap()
    };
    assert!(collisions(&fresh) > 2, "{fresh}");
    assert_eq!(collisions(&brought), 0, "{brought}");
    let [fresh, brought] = [&fresh, &brought].map(|report| steps_to_optimum(report));
    assert!(brought < fresh, "{brought} steps, {fresh} without");
}

#[test]
fn a_run_that_began_with_rules_is_repeated_from_its_recording() {
    let desk = Desk::new("xcscr-plus");
    let args = [
        "train",
        world("maze6"),
        "--method",
        "xcscr-plus",
        "--episodes",
        "3",
        "--quiet",
    ];
    desk.fine(
        &[
            &args[..],
            &["--init-rules", "run/rules.json", "--out", "next"],
        ]
        .concat(),
    );
    let text = desk.fine(&["recording", "verify", "next"]);
    let said = "5 of 5 recordings are bit-identical";
    assert!(
        text.contains(said),
        "three episodes, the run, the highlights recording: {text}"
    );
}

#[test]
fn rules_with_a_map_are_refused_by_methods_without_one_before_anything_is_written() {
    let desk = Desk::on_a_map();
    for method in ["xcs", "adapted-even", "xcscr", "xcscr-coevolved", "r-max"] {
        let start = train(method, "maze4", "next");
        let (code, message) = desk.refused(&[&start[..], &["--init-rules", "run"]].concat());
        let named = format!("the method `{method}` cannot start from these rules");
        assert!(code == Some(65) && message.contains(&named), "{message}");
        assert!(!desk.0.path().join("next").exists(), "{method}");
    }
}

#[test]
fn rules_of_another_kind_are_refused_before_anything_is_written() {
    let desk = Desk::new("xcs");
    for method in ["xcscr-plus", "q-learning"] {
        let args = [
            &train(method, "maze5", "next")[..],
            &["--init-rules", "run"],
        ]
        .concat();
        let (code, message) = desk.refused(&args);
        assert_eq!(code, Some(65), "{message}");
        assert!(message.contains(method), "{message}");
        assert!(!desk.0.path().join("next").exists());
    }
    desk.fine(
        &[
            &train("xcscr", "maze5", "next")[..],
            &["--init-rules", "run"],
        ]
        .concat(),
    );
}

#[test]
fn a_generated_maze_is_solvable_and_the_same_again() {
    let desk = Desk(tempfile::tempdir().unwrap());
    for kind in ["dfs", "rooms", "random", "corridors"] {
        let args = [
            "world", "generate", "--kind", kind, "--size", "9", "--seed", "5",
        ];
        let maze = desk.fine(&args);
        assert_eq!(desk.fine(&args), maze);
        desk.keep("maze.json", &maze);
        let check = desk.fine(&["world", "check", "maze.json"]);
        assert!(check.contains(&format!("{kind}-9-5")), "{check}");
    }
    let (code, message) = desk.refused(&["world", "generate", "--kind", "dfs", "--size", "4"]);
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("from 5 to 1024"), "{message}");
}

#[test]
fn a_study_compares_worlds_to_learn_in_beforehand_and_switches() {
    let desk = Desk(tempfile::tempdir().unwrap());
    let study = r#"
        name = "both"
        worlds = ["rooms-8-1"]
        after = ["nothing", "maze4"]
        methods = ["xcscr-plus"]
        trials = 3
        episodes = 10
        without = ["plus.return_rules"]
        [world-settings]
        rooms-8-1 = { "reward.step_threshold" = 60 }
        [world-sensors]
        rooms-8-1 = ["neighbours-position"]
    "#;
    desk.keep("both.toml", study);
    desk.fine(&["study", "run", "both.toml", "--out", "both"]);
    let table = std::fs::read_to_string(desk.0.path().join("both/trials.csv")).unwrap();
    for variant in [
        "after=nothing without=nothing",
        "after=nothing without=plus.return_rules",
    ] {
        assert_eq!(table.matches(variant).count(), 3, "{table}");
    }
    assert_eq!(table.matches("after=maze4").count(), 6, "{table}");
    assert_eq!(table.matches("neighbours-position").count(), 12, "{table}");
}

#[test]
fn why_tells_who_votes_what_would_change_it_and_how_the_rule_came_to_be() {
    let desk = Desk::new("xcscr-plus");
    let told = desk.fine(&["rules", "run", "--why", "1,1"]);
    assert!(told.starts_with("maze4, neighbours, cell 1,1\n"), "{told}");
    assert!(
        told.contains("perceives   north wall, north-east wall, east free"),
        "{told}"
    );
    assert!(told.contains("goes        east   (values: east "), "{told}");
    assert!(
        told.contains("100 %"),
        "one rule has the whole vote: {told}"
    );
    assert!(
        told.contains("has been among the rules since episode "),
        "{told}"
    );
    // A lone file of rules knows no episodes.
    let lone = [
        "rules",
        "run/rules.json",
        "--world",
        world("maze4"),
        "--sensor",
        "neighbours",
    ];
    let lone = desk.fine(&[&lone[..], &["--why", "1,1"]].concat());
    assert!(
        told.starts_with(&lone) && !lone.contains("episode"),
        "{lone}"
    );
    // What is said to lead elsewhere does: in the cell that is named, the robot goes that way.
    let mut named = 0;
    for cell in ["1,4", "2,4", "3,4", "4,4", "5,5", "4,6"] {
        let told = desk.fine(&["rules", "run", "--why", cell]);
        for line in told.lines().filter(|line| line.contains("(as in cell ")) {
            let (way, rest) = line.trim().split_once(' ').unwrap();
            let (_, there) = rest.trim_end_matches(')').rsplit_once(' ').unwrap();
            let there = desk.fine(&["rules", "run", "--why", there]);
            assert!(
                there.contains(&format!("goes        {way} ")),
                "{line}: {there}"
            );
            named += 1;
        }
    }
    assert!(named > 0, "no cell of this world is named");
    for (cell, fault) in [
        ("0,0", "there is no free cell 0,0"),
        ("6,6", "6,6 is a goal"),
    ] {
        let (code, message) = desk.refused(&["rules", "run", "--why", cell]);
        assert!(code == Some(2) && message.contains(fault), "{message}");
    }
}

#[test]
fn diff_shows_the_rules_that_only_one_has_and_where_they_part() {
    let desk = Desk::new("xcscr-plus");
    let same = desk.fine(&["rules", "run", "--diff", "run"]);
    assert!(
        same.contains("The best actions are the same in every cell."),
        "{same}"
    );
    assert!(!same.contains("Only in"), "{same}");
    desk.fine(&[&train("xcscr-plus", "maze4", "other")[..], &["--seed", "2"]].concat());
    let differ = desk.fine(&["rules", "run", "--diff", "other"]);
    assert!(differ.contains("Only in the first:"), "{differ}");
    desk.fine(&train("q-learning", "maze4", "table"));
    let (code, message) = desk.refused(&["rules", "run", "--diff", "table"]);
    assert!(
        code == Some(65) && message.contains("it has no rules"),
        "{message}"
    );
}

#[test]
fn a_plan_on_a_map_is_driven_by_and_drawn_but_has_no_rules_to_print_or_to_export() {
    let desk = Desk::on_a_map();
    let said = desk.fine(&[&train("r-max", "maze4", "planned")[..], &ON_A_MAP].concat());
    assert!(
        said.contains("\n  beliefs  ") && !said.contains("\n  rules"),
        "{said}"
    );
    let said = desk.fine(&["evaluate", "planned", "--require-optimal"]);
    assert!(said.contains(" beliefs on grid"), "{said}");
    let said = desk.fine(&["evaluate", "run"]);
    assert!(said.contains(" rules on grid"), "control: {said}");
    desk.fine(&["map", "planned", "--output", "map.svg"]);
    for (args, words) in [
        (
            &["rules", "planned"][..],
            "a plan on a map; it has no rules",
        ),
        (
            &["export", "planned", "--target", "c99"],
            "train xcscr-plus",
        ),
    ] {
        let (code, message) = desk.refused(args);
        assert!(code == Some(65) && message.contains(words), "{message}");
    }
    desk.fine(&["export", "run", "--target", "c99"]);
}

#[test]
fn a_page_shows_the_policy_the_rules_and_where_they_lead_in_each_cell() {
    let desk = Desk::new("xcscr-plus");
    let page = desk.fine(&["rules", "run", "--format", "html"]);
    let rules = count(&desk.fine(&["rules", "run", "--format", "json"]));
    // Maze4 has 26 free cells that are no goals; each table has a heading.
    assert_eq!(page.matches("<tr>").count(), 1 + rules + 1 + 26, "{page}");
    let [policy, predicted] = ["<svg", "the opposite action undoes a move"];
    assert!(page.contains(policy) && page.contains(predicted), "{page}");
    for loaded in ["http:", "https:", " src="] {
        assert!(!page.contains(loaded), "the page names {loaded}");
    }
    for address in page.split("href=\"").skip(1) {
        assert!(address.starts_with('#'), "{address}");
    }
    // A lone file of rules tells no run, and so there is no policy to draw.
    let lone = ["rules", "run/rules.json", "--world", world("maze4")];
    let lone = desk.fine(&[&lone[..], &["--sensor", "neighbours", "--format", "html"]].concat());
    assert!(!lone.contains(policy) && lone.contains(predicted), "{lone}");
    let (code, message) = desk.refused(&["rules", "run", "--format", "html", "--csv"]);
    assert!(code == Some(2) && message.contains("--format"), "{message}");
}

#[test]
fn the_page_of_a_vast_maze_says_what_it_does_not_draw() {
    let desk = Desk(tempfile::tempdir().unwrap());
    let vast = desk.fine(&["world", "generate", "--kind", "dfs", "--size", "150"]);
    desk.keep("vast.json", &vast);
    let train = [
        "train",
        "vast.json",
        "--arena",
        "grid",
        "--episodes",
        "1",
        "--quiet",
    ];
    desk.xcscr(&[&train[..], &["--record", "none", "--out", "run"]].concat());
    let page = desk.fine(&["rules", "run", "--format", "html"]);
    assert!(
        page.len() < 1_000_000 && !page.contains("<svg"),
        "{}",
        page.len()
    );
    for omitted in ["a picture of its policy", "at most 400 are listed"] {
        assert!(page.contains(omitted), "{omitted}");
    }
}
