//! Studies as their users run them: whole, in tasks, interrupted, mixed up.
//!
//! The promise is that the folder of a finished study holds the same tables and report, byte for byte,
//! and the same trials, however it came about.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use crate::kit::folder;
use crate::kit::program::{expect, wait_until};
use crate::study::desk::{Desk, SMALL};
use serde_json::{Value, json};

#[test]
fn the_same_bytes_for_any_number_of_jobs() {
    let desk = Desk::new();
    for jobs in [2, 8] {
        desk.done(&format!("run small.toml --out jobs{jobs} --jobs {jobs}"));
        desk.assert_whole(&format!("jobs{jobs}"));
    }
}

#[cfg(unix)]
#[test]
fn links_in_a_study_folder_lead_nobody_out_of_it() {
    let desk = Desk::new();
    desk.done("run small.toml --trials 1 --out a");
    desk.write("precious", "precious");
    for name in ["trials.csv", "report.md", "curves.svg"] {
        let _ = fs::remove_file(desk.path("a").join(name));
        std::os::unix::fs::symlink(desk.path("precious"), desk.path("a").join(name)).unwrap();
    }
    let words = "run small.toml --trials 1 --out a";
    desk.refused(words, 73, "trials.csv exists");
    desk.done(&format!("{words} --force"));
    assert_eq!(desk.read("precious"), "precious");
}

#[test]
fn force_removes_journals_and_no_other_file_beside_them() {
    let desk = Desk::new();
    desk.done("run small.toml --trials 1 --out a");
    let foreign = "a/journals/notes.txt";
    desk.write(foreign, "mine");
    desk.done("status a");
    desk.write("a/journals/0123456789.journal", "mine, too");
    let other = "run small.toml --trials 1 --seed 8 --out a --force";
    desk.refused(other, 73, "0123456789.journal is not a journal of xcscr");
    assert_eq!(desk.trials("a").len(), 4, "nothing was removed");
    fs::remove_file(desk.path("a/journals/0123456789.journal")).unwrap();
    desk.done(other);
    assert_eq!(desk.read(foreign), "mine");
    assert_eq!(folder::names(&desk.path("a/journals")).len(), 2);
}

#[test]
fn an_incomplete_study_is_no_result_and_status_says_what_is_missing() {
    let desk = Desk::new();
    let begin = |study: &str, tasks: usize, out: &str, run: &[usize]| {
        desk.done(&format!("plan {study} --tasks {tasks} --out {out}"));
        for task in run {
            desk.done(&format!("task {out} {task}"));
        }
    };
    begin("small.toml", 4, "a", &[1, 3]);
    desk.refused("report a", 1, "8 of 16 trials are missing");
    assert!(!desk.path("ab").exists());
    // What is finished is shown, but not tested, and no file says that it is the result.
    let (shown, said) = desk.ends("report a", 1);
    for text in [&shown, &said] {
        assert!(text.contains("8 of 16 trials are missing"), "{text}");
    }
    let is_tested = shown.contains("Tests") || shown.contains("Fewest");
    assert!(shown.contains("maze4") && !is_tested, "{shown}");
    assert!(!desk.path("a/report.md").exists() && !desk.path("a/trials.csv").exists());
    let shown: Value = serde_json::from_str(&desk.ends("report a --json", 1).0).unwrap();
    assert_eq!(
        (&shown["missing"], &shown["comparisons"]),
        (&json!(8), &json!([]))
    );
    let status = desk.done("status a");
    for words in [
        "8 of 16 trials finished",
        "missing (8):\n    maze4 xcs grid neighbours: 2 4\n    maze4 xcscr",
        "4 tasks, 2 of them with missing trials",
    ] {
        assert!(status.contains(words), "{words}: {status}");
    }
    assert_eq!(desk.json("status a --json")["finished"], 8);
    // Arms without a finished trial have no interval.
    begin("small.toml", 16, "c", &[1]);
    let report = desk.ends("report c", 1).0;
    let row = |head: &str| report.lines().find(|line| line.starts_with(head)).unwrap();
    assert!(row("maze4  xcs ").contains(" % "), "{report}");
    for head in ["maze4  xcscr", "maze5  xcs ", "maze5  xcscr"] {
        assert!(row(head).contains(" 0   0              –"), "{report}");
    }
    // A hundred arms that have not begun are not listed.
    let sweep = "[sweep]\n\"xcs.mu\" = [0.1, 0.2, 0.3, 0.4]\n";
    desk.write("wide.toml", &(SMALL.to_owned() + sweep));
    begin("wide.toml --trials 2 --episodes 2", 32, "d", &[1]);
    let status = desk.done("status d");
    assert!(
        status.contains("all 2 trials of each of 15 arms"),
        "{status}"
    );
}

#[test]
fn a_trial_that_fails_is_a_row_with_its_error() {
    let desk = Desk::new();
    // Physics refuses a world whose edges join.
    let text = SMALL.replace("\"maze5\"", "\"woods1\"") + "arenas = [\"physics\"]\n";
    desk.write("mixed.toml", &text);
    let words = "run mixed.toml --out a --trials 1 --episodes 2";
    desk.refused(words, 1, "2 trials failed");
    let table = desk.read("a/trials.csv");
    let rows: Vec<&str> = table.lines().collect();
    assert_eq!(rows.len(), 5, "{table}");
    let is_fine = rows[1].starts_with("maze4,xcs,physics,") && rows[1].ends_with(',');
    assert!(is_fine, "{table}");
    let is_told = rows[3].starts_with("woods1,xcs,physics,") && rows[3].contains("joins its edges");
    assert!(is_told, "{table}");
    desk.refused(words, 1, "2 trials failed");
    desk.refused(&format!("{words} --retry-failed"), 1, "2 trials failed");
}

#[test]
fn a_failed_trial_is_repeated_on_request_and_the_study_is_as_if_it_had_never_failed() {
    let desk = Desk::new();
    for study in ["whole", "a"] {
        desk.done(&format!("run small.toml --out {study} --quiet"));
    }
    desk.done("episodes whole");
    for trial in [("maze4 xcs ", 1), ("maze4 xcscr ", 2)] {
        desk.edit_record("a", trial, |record| {
            record["result"] = serde_json::json!({ "Err": "no space left on device" });
        });
    }
    desk.refused("run small.toml --out a --force", 1, "2 trials failed");
    let status = desk.json("status a --json");
    assert_eq!(status["failed"], serde_json::json!([0, 5]));
    desk.refused(
        "episodes a --force",
        65,
        "has another result when it is repeated",
    );
    desk.done("run small.toml --out a --retry-failed --quiet");
    desk.done("episodes a");
    for name in ["trials.csv", "summary.json", "report.md", "episodes.csv.gz"] {
        let [one, other] = ["a", "whole"].map(|study| desk.path(study).join(name));
        assert!(fs::read(one).unwrap() == fs::read(other).unwrap(), "{name}");
    }
    desk.done("run small.toml --out a --retry-failed --quiet");
    assert!(desk.path("a/episodes.csv.gz").exists(), "nothing failed");
    let status = desk.json("status a --json");
    assert_eq!(status["failed"], serde_json::json!([]));
}

#[test]
fn a_folder_in_use_is_refused_with_the_holder_and_a_dead_holder_does_not_matter() {
    let desk = Desk::new();
    let words = "run small.toml --out a --trials 60 --jobs 1 --quiet";
    let mut child = desk.begin(words);
    wait_until("a trial", || !desk.trials("a").is_empty());
    let holder = format!("is in use by process {}", child.id());
    desk.refused(words, 73, &holder);
    child.kill().unwrap();
    child.wait().unwrap();
    desk.refused("run small.toml --out a", 73, "another study");
    desk.done(words);
}

#[test]
fn faults_in_a_study_and_in_its_commands_are_told_with_the_way_out() {
    let desk = Desk::new();
    desk.write("typo.toml", &SMALL.replace("episodes", "episods"));
    desk.write("method.toml", &SMALL.replace("\"xcs\"", "\"xxx\""));
    for (words, code, message) in [
        ("run typo.toml --out x", 65, "did you mean `episodes`?"),
        (
            "run small.toml --out x --set xcs.betta=1",
            65,
            "did you mean `xcs.beta`?",
        ),
        (
            "run method.toml --out x",
            65,
            "method.toml: there is no method `xxx`, only xcs, xcsam,",
        ),
        (
            "run none.toml --out x",
            66,
            "paper, ablation, defaults, sensing",
        ),
        ("run small.toml --out x --jobs 100000", 2, ""),
        ("status x", 66, ""),
    ] {
        desk.refused(words, code, message);
        assert!(!desk.path("x").exists(), "nothing was begun");
    }
    desk.done("run small.toml --out a --trials 1");
    desk.refused("run small.toml --out a --episodes 2", 73, "another study");
    let plan = desk.read("a/study.json");
    let changed = plan.replace("\"beta\": 0.2", "\"beta\": 0.3");
    let frozen = "study.json is damaged: it was changed after it was frozen";
    let half = &plan[..plan.len() / 2];
    for (plan, message) in [(changed.as_str(), frozen), (half, "study.json is damaged")] {
        desk.write("a/study.json", plan);
        desk.refused("report a", 65, message);
    }
}

/// The journal of a study of 12 episodes, and its lines, in the order of the trials.
fn journal(desk: &Desk) -> (PathBuf, Vec<String>) {
    desk.done("run small.toml --out a --trials 2 --jobs 1");
    let path = folder::journal(&desk.path("a"));
    let text = fs::read_to_string(&path).unwrap();
    (path, text.lines().map(str::to_owned).collect())
}

fn keep(path: &PathBuf, lines: &[String]) {
    fs::write(path, lines.join("\n") + "\n").unwrap();
}

/// The same with other figures in the line of a trial, and the right checksum.
fn forge(line: &str, figure: &str, value: Value) -> String {
    let mut record: Value = serde_json::from_str(&line[9..]).unwrap();
    let figures = &mut record["result"]["Ok"];
    match figures["progress"].get_mut(figure) {
        Some(progress) => *progress = value,
        None => figures[figure] = value,
    }
    let json = record.to_string();
    format!("{:08x} {json}", crc32fast::hash(json.as_bytes()))
}

#[test]
fn one_flipped_bit_in_a_journal_is_damage_and_takes_no_finished_trial_away() {
    let desk = Desk::new();
    let (path, mut lines) = journal(&desk);
    let sound = lines[2].clone();
    lines[2] = sound.replacen("\"steps\"", "\"stepr\"", 1);
    assert_ne!(lines[2], sound);
    keep(&path, &lines);
    let run = "run small.toml --out a --trials 2";
    for words in ["status a", "report a", run] {
        desk.refused(words, 65, "line 3 is damaged");
        assert_eq!(fs::read_to_string(&path).unwrap(), lines.join("\n") + "\n");
    }
    // Control: the way out that the message names.
    lines.remove(2);
    keep(&path, &lines);
    desk.done(run);
}

#[test]
fn journals_that_contradict_themselves_or_each_other_are_refused() {
    let desk = Desk::new();
    let (path, mut lines) = journal(&desk);
    let sound = lines.clone();
    lines.push(lines[3].clone());
    keep(&path, &lines);
    desk.done("status a");
    lines.push(forge(&lines[3], "rules", 999.into()));
    keep(&path, &lines);
    desk.refused(
        "status a",
        65,
        "another result of trial 1 of maze4 xcscr grid neighbours than an earlier line",
    );
    keep(&path, &sound);
    // Another journal beside this one.
    lines = sound;
    lines[1] = forge(&lines[1], "rules", 999.into());
    let name = "zzzzzzzzzz.journal";
    let twin = path.with_file_name(name);
    keep(&twin, &lines);
    let message = "another result of trial 1 of maze4 xcs grid";
    desk.refused("report a", 65, message);
    desk.refused("report a", 65, name);
}

#[test]
fn figures_that_no_trial_can_have_are_reported_without_a_panic() {
    let desk = Desk::new();
    let (path, lines) = journal(&desk);
    let figures = [
        ("first_optimal_episode", json!(u32::MAX)),
        ("first_optimal_env_steps", json!(u64::MAX)),
        ("optimal", json!(true)),
        ("steps", json!(u64::MAX)),
        ("rules", json!(u64::MAX)),
    ];
    let forged = |line: &String| {
        let forge =
            |line: String, (figure, value): &(&str, Value)| forge(&line, figure, value.clone());
        figures.iter().fold(line.clone(), forge)
    };
    let forged: Vec<String> = lines[1..].iter().map(forged).collect();
    keep(&path, &[&lines[..1], &forged].concat());
    desk.done("report a --force");
}

#[test]
fn a_trial_of_a_study_is_the_same_as_training_with_its_seed() {
    let table = Desk::finished().read("whole/trials.csv");
    let cells = |line: usize| table.lines().nth(line).unwrap().split(',');
    let row: BTreeMap<&str, &str> = cells(0).zip(cells(5)).collect();
    assert_eq!([row["world"], row["method"]], ["maze4", "xcscr"]);
    let words = "train worlds/maze4.json --method xcscr --arena grid --episodes 12 --record none";
    let desk = Desk::new();
    let words = format!("{words} --json --out {}", desk.path("run").display());
    let words = format!("{words} --seed {}", row["seed"]);
    let (trained, _) = expect(0, &words.split(' ').collect::<Vec<_>>());
    let trained: Value = serde_json::from_str(&trained).unwrap();
    assert_eq!(trained["steps"].to_string(), row["steps"]);
    assert_eq!(trained["collisions"].to_string(), row["collisions"]);
}
