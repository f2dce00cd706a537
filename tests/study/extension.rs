//! Trials, methods and worlds are added to a study, and its reference method is chosen.

use std::fs;

use serde_json::Value;

use super::desk::Desk;
use crate::kit::program::wait_until;

/// The files of a study except its plan and its journals.
fn results(desk: &Desk, study: &str) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(desk.path(study)).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let is_result = |path: &std::path::PathBuf| path.is_file() && !path.ends_with("study.json");
    let file = |path: std::path::PathBuf| {
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        (name, fs::read(&path).unwrap())
    };
    let mut files: Vec<_> = paths.filter(is_result).map(file).collect();
    files.sort();
    files
}

#[test]
fn an_extended_study_is_as_if_it_had_been_run_at_once_and_repeats_no_trial() {
    let desk = Desk::new();
    let small = desk.read("small.toml");
    let part = small.replace("\"maze4\", ", "").replace("\"xcs\", ", "");
    desk.write("part.toml", &part);
    desk.done("run part.toml --trials 2 --out a --quiet");
    assert_eq!(desk.trials("a").len(), 2);
    desk.done("run part.toml --trials 3 --out a --quiet");
    assert_eq!(desk.trials("a").len(), 3);
    desk.done("run small.toml --out a --quiet");
    assert_eq!(desk.trials("a").len(), 16);
    desk.done("run small.toml --out b --quiet");
    assert_eq!(results(&desk, "a"), results(&desk, "b"));
    desk.done("report a");
    desk.done("episodes a");
    let fewer = "run small.toml --trials 3 --out a";
    desk.refused(fewer, 73, "another study (`trials` is `3`, but `4` there)");
}

#[test]
#[cfg(unix)]
fn a_smaller_study_stays_until_the_larger_one_is_finished() {
    let desk = Desk::new();
    desk.done("run small.toml --trials 2 --out a --quiet");
    let [plan, before] = [desk.read("a/study.json"), desk.done("report a")];
    let files = results(&desk, "a");
    for kept in [10, 14] {
        desk.signalled(
            "run small.toml --trials 40 --out a --jobs 1",
            "a",
            kept,
            "KILL",
        );
        // Without its number, and with it.
        for command in ["report a", "run small.toml --trials 2 --out a --quiet"] {
            assert_eq!(desk.done(command), before);
            assert_eq!(desk.read("a/study.json"), plan);
            assert!(
                files == results(&desk, "a"),
                "{command} changed the results"
            );
        }
    }
    let kept = desk.trials("a").len();
    assert!(
        (14..160).contains(&kept),
        "control: {kept} trials were kept"
    );
    desk.done("run small.toml --trials 40 --out a --quiet");
    assert_eq!(desk.trials("a").len(), 160);
    desk.done("run small.toml --trials 40 --out b --quiet");
    assert!(results(&desk, "a") == results(&desk, "b"));
}

#[test]
fn growth_keeps_files_that_are_not_those_of_the_smaller_study() {
    let desk = Desk::new();
    desk.done("run small.toml --trials 1 --out a --quiet");
    let grow = "run small.toml --trials 2 --out a --quiet";
    let reference = "run small.toml --trials 1 --reference xcs --out a --quiet";
    for name in ["report.md", "trials.csv", "curves.svg", "episodes.csv.gz"] {
        let file = desk.path("a").join(name);
        let before = fs::read(&file).ok();
        fs::write(&file, "mine").unwrap();
        for words in [grow, reference] {
            desk.refused(words, 73, &format!("({name})"));
            assert_eq!(fs::read(&file).unwrap(), b"mine", "{words}");
        }
        assert_eq!(desk.trials("a").len(), 4, "no trial was run");
        match before {
            Some(before) => fs::write(&file, before).unwrap(),
            None => fs::remove_file(&file).unwrap(),
        }
    }
    for name in ["report.md", "episodes.csv.gz", "notes.txt"] {
        desk.write(&format!("a/{name}"), "mine");
    }
    desk.done(&format!("{grow} --force"));
    assert_eq!(desk.read("a/notes.txt"), "mine");
    assert!(!desk.path("a/episodes.csv.gz").exists());
    assert_ne!(desk.read("a/report.md"), "mine");
    // Control: an unchanged report is no hindrance.
    desk.done("run small.toml --trials 3 --out a --quiet");
}

#[test]
fn the_report_of_the_smaller_study_is_printed_while_it_grows() {
    let desk = Desk::new();
    desk.done("run small.toml --trials 1 --out a --quiet");
    let (before, files) = (desk.done("report a"), results(&desk, "a"));
    let mut child = desk.begin("run small.toml --trials 90 --out a --jobs 1 --quiet");
    wait_until("a trial", || desk.trials("a").len() > 4);
    let (report, note) = desk.ends("report a", 0);
    assert!(report.contains("xcscr"), "{report}");
    assert!(report.lines().all(|line| before.contains(line)), "{report}");
    let holder = format!("nothing was written: a is in use by process {}", child.id());
    assert!(note.contains(&holder), "{note}");
    for words in ["episodes a", "report a --force"] {
        desk.refused(words, 73, "wait for it, or use another folder");
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(desk.done("report a"), before);
    assert!(results(&desk, "a") == files);
}

#[test]
fn a_study_in_tasks_is_extended_too() {
    let desk = Desk::new();
    desk.done("plan small.toml --trials 2 --tasks 3 --out a");
    for task in 1..=3 {
        desk.done(&format!("task a {task} --quiet"));
    }
    let small = desk.done("report a");
    let plan = "plan small.toml --tasks 3 --out a";
    desk.refused(plan, 73, "a smaller study (`trials` is `4`, but `2` there)");
    desk.done("run small.toml --out a --quiet");
    desk.done("task a 2 --quiet");
    assert_eq!(desk.trials("a").len(), 16);
    assert_ne!(desk.done("report a"), small);
    assert_eq!(results(&desk, "a"), results(&Desk::finished(), "whole"));
}

#[test]
fn a_chosen_reference_is_compared_with_each_other_method_and_no_trial_is_repeated() {
    let desk = Desk::new();
    let compared = |study: &str| {
        let report = desk.json(&format!("report {study} --json"));
        let comparisons = report["comparisons"].as_array().unwrap().clone();
        let word = |one: &Value, key: &str| one[key].as_str().unwrap().to_owned();
        let pair = |one: &Value| (word(one, "method"), word(one, "against"));
        let mut pairs: Vec<_> = comparisons.iter().map(pair).collect();
        pairs.dedup();
        pairs
    };
    let pair = |one: &str, other: &str| vec![(one.to_owned(), other.to_owned())];
    desk.done("run small.toml --out a --quiet");
    assert_eq!(compared("a"), pair("xcscr", "xcs"));
    desk.done("run small.toml --reference xcs --out a --quiet");
    assert_eq!(compared("a"), pair("xcs", "xcscr"));
    assert_eq!(desk.trials("a").len(), 16);
    let unknown = "run small.toml --reference r-max --out b";
    desk.refused(unknown, 65, "give one of xcs, xcscr");
}
