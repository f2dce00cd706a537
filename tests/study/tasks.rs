//! Studies in tasks, as a cluster runs them: killed, doubled, in any order.

use std::fs;
use std::os::unix::fs::symlink;
use std::process::Command;

use crate::kit::folder;
use crate::study::desk::Desk;
use xcscr::streams::StreamName;
use xcscr::xcs::random::Stream;

/// The journals of a study have each of so many trials once.
#[track_caller]
fn assert_each_once(desk: &Desk, name: &str, trials: usize) {
    let mut found = desk.trials(name);
    assert_eq!(found.len(), trials, "{name}");
    found.sort_unstable();
    found.dedup();
    assert_eq!(found.len(), trials, "{name}");
}

#[test]
fn a_plan_says_what_would_be_run_and_writes_nothing_unless_told_where() {
    let desk = Desk::finished();
    let before = folder::names(&desk.path(""));
    let said = desk.done("plan small.toml --tasks 5");
    for words in [
        "4 arms x 4 trials of 12 episodes = 16 trials",
        "5 tasks of at most 4 trials",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
    assert_eq!(folder::names(&desk.path("")), before);
    let [plan, status] = ["plan small.toml --json", "status whole --json"];
    assert_eq!(desk.json(plan)["plan"], desk.json(status)["plan"]);
}

#[test]
fn tasks_in_any_order_and_again_give_the_bytes_of_one_process() {
    let desk = Desk::new();
    for tasks in [1, 3, 16] {
        let out = format!("split{tasks}");
        desk.done(&format!("plan small.toml --tasks {tasks} --out {out}"));
        for task in (1..=tasks).rev() {
            desk.done(&format!("task {out} {task} --jobs {}", 1 + task % 3));
        }
        // A finished task runs nothing again.
        desk.done(&format!("task {out} 1"));
        assert_each_once(&desk, &out, 16);
        desk.done(&format!("report {out}"));
        desk.assert_whole(&out);
    }
    // One process finishes what tasks began, and tasks what one process began.
    desk.done("plan small.toml --tasks 3 --out split");
    desk.done("task split 2");
    desk.done("task split 1");
    desk.done("run small.toml --out split --quiet");
    assert_each_once(&desk, "split", 16);
    desk.assert_whole("split");
}

#[test]
fn the_array_job_that_a_plan_prints_runs_every_task() {
    let desk = Desk::new();
    fs::create_dir(desk.path("bin")).unwrap();
    symlink(env!("CARGO_BIN_EXE_xcscr"), desk.path("bin/xcscr")).unwrap();
    let said = desk.done("plan small.toml --tasks 3 --out split");
    let script = &said[said.find("#!/bin/sh").unwrap()..];
    assert!(script.contains("\n#SBATCH --array=1-3\n"), "{script}");
    desk.write("array.sh", script);
    for task in 1..=3 {
        desk.refused("report split", 1, "trials are missing");
        let path = format!("{}:/usr/bin:/bin", desk.path("bin").display());
        let mut job = Command::new("sh");
        job.arg("array.sh").current_dir(desk.path(""));
        job.env("PATH", path)
            .env("SLURM_ARRAY_TASK_ID", task.to_string());
        assert!(job.status().unwrap().success(), "task {task}");
    }
    desk.done("report split");
    desk.assert_whole("split");
}

#[test]
fn what_is_not_finished_is_not_reported_and_status_tells_the_tasks() {
    let desk = Desk::new();
    desk.done("plan small.toml --tasks 5 --out split");
    desk.done("task split 2");
    desk.done("task split 4");
    let said = desk.done("status split");
    for words in [
        "6 of 16 trials finished",
        "5 tasks, 3 of them with missing trials",
        "--array=1,3,5",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
    desk.refused("report split", 1, "10 of 16 trials are missing");
    assert!(!desk.path("split/trials.csv").exists());
}

#[cfg(feature = "long")]
#[test]
fn killed_at_any_moment_a_study_keeps_what_it_finished_and_runs_none_of_it_again() {
    let desk = Desk::new();
    desk.done("run small.toml --trials 30 --out whole");
    let mut moments = Stream::new(1, StreamName::World);
    for (jobs, is_task) in [(1, true), (3, true), (2, false)] {
        let out = format!("killed{jobs}");
        let run = format!("run small.toml --trials 30 --out {out} --quiet --jobs {jobs}");
        let words = match is_task {
            true => {
                let plan = format!("plan small.toml --trials 30 --tasks 1 --out {out}");
                desk.done(&plan);
                format!("task {out} 1 --quiet --jobs {jobs}")
            }
            false => run,
        };
        let mut known = 0;
        for _ in 0..6 {
            desk.signalled(&words, &out, known + 1 + moments.below(8), "KILL");
            let kept = desk.trials(&out).len();
            assert!(kept > known, "{kept} are left of {known} trials");
            known = kept;
        }
        assert!(known < 120, "control: no attempt was interrupted");
        desk.done(&words);
        // No trial is in two journals: what was finished was seen by the next attempt.
        assert_each_once(&desk, &out, 120);
        desk.done(&format!("report {out}"));
        desk.assert_same(&out, "whole");
    }
}

#[test]
fn a_signal_ends_a_study_in_order_with_code_75_and_the_next_attempt_goes_on() {
    let desk = Desk::new();
    desk.done("plan small.toml --trials 100 --tasks 2 --out split");
    for (words, name, signal) in [
        ("task split 1 --jobs 1", "split", "USR1"),
        ("task split 1 --jobs 1", "split", "TERM"),
        ("run small.toml --out a --trials 200 --jobs 1", "a", "TERM"),
    ] {
        let before = desk.trials(name).len();
        let code = desk.signalled(words, name, before + 2, signal);
        assert_eq!(code, Some(75), "{words}: {signal}");
        let kept = desk.json(&format!("status {name} --json"))["finished"].clone();
        assert_eq!(kept, desk.trials(name).len(), "{words}: {signal}");
        assert!(!desk.path(name).join("trials.csv").exists());
    }
}

#[test]
fn another_study_another_split_and_another_program_are_refused() {
    let desk = Desk::new();
    desk.done("plan small.toml --tasks 4 --out split");
    desk.done("plan small.toml --tasks 4 --out split");
    for (words, code, message) in [
        (
            "plan small.toml --tasks 5 --out split",
            73,
            "split is split into 4 tasks, not 5",
        ),
        (
            "plan small.toml --seed 8 --tasks 4 --out split",
            73,
            "split contains another study (`seed` is `8`, but `7` there)",
        ),
        ("task split 5", 2, ""),
        ("task nowhere 1", 66, ""),
        (
            "plan small.toml --tasks 17",
            65,
            "`tasks` is 17, but must be from 1 to 16",
        ),
    ] {
        desk.refused(words, code, message);
    }
    let plan = desk.read("split/study.json");
    for (key, other, message) in [
        (
            "\"seed\": 7",
            "\"seed\": 8",
            "it was changed after it was frozen",
        ),
        (
            "\"tasks\": 4",
            "\"tasks\": 2",
            "the number of tasks or an arm was changed",
        ),
    ] {
        desk.write("split/study.json", &plan.replace(key, other));
        desk.refused("task split 1", 65, message);
    }
    desk.write("split/study.json", &plan);
    fs::remove_dir(desk.path("split/journals")).unwrap();
    desk.write("split/journals", "in the way");
    // No option is named that a task does not have.
    let (_, said) = desk.ends("task split 1", 74);
    let is_told = said.contains("journals") && !said.contains("--out");
    assert!(is_told, "{said}");
}

#[test]
fn a_folder_that_holds_something_else_is_refused_by_what_it_holds_and_left_as_it_is() {
    let desk = Desk::new();
    let kinds = ["notes", "whole", "split"];
    let [plan, run] = [
        "plan small.toml --tasks 4 --out",
        "run small.toml --force --out",
    ];
    fs::create_dir(desk.path("notes")).unwrap();
    desk.write("notes/search.md", "mine");
    desk.done(&format!("{run} whole"));
    desk.done(&format!("{plan} split"));
    let before = kinds.map(|kind| folder::names(&desk.path(kind)));
    let foreign = "contains files that xcscr did not create";
    for (kind, message, refused) in [
        ("notes", foreign, vec![plan, run]),
        ("whole", "is split into 1 tasks, not 4", vec![plan]),
    ] {
        for command in &refused {
            desk.refused(&format!("{command} {kind}"), 73, message);
        }
    }
    assert_eq!(kinds.map(|kind| folder::names(&desk.path(kind))), before);
}
