//! Studies in tasks, as a cluster runs them: killed, doubled, in any order. The engine is played by two
//! scripts here; `tests/slurm/run` takes the real one.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use crate::desk::Desk;
use crate::kit::folder;
use serde_json::Value;
use xcscr::streams::StreamName;
use xcscr::xcs::random::Stream;

/// A folder with an engine that notes what it is asked.
pub fn desk() -> Desk {
    let desk = Desk::new();
    desk.write("queue", "");
    fs::create_dir(desk.path("bin")).unwrap();
    let here = desk.path("").display().to_string();
    play(&desk, "squeue", &format!("cat {here}/queue"));
    let sbatch = format!("echo \"$PWD $*\" >> {here}/submitted; wc -l < {here}/submitted");
    play(&desk, "sbatch", &sbatch);
    desk
}

/// Puts a script in the place of a program.
fn play(desk: &Desk, name: &str, script: &str) {
    let path = desk.path("bin").join(name);
    fs::write(&path, format!("#!/bin/sh\n{script}\n")).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
}

fn status(desk: &Desk, folder: &str) -> Value {
    serde_json::from_str(&desk.done(&format!("status {folder} --json"))).unwrap()
}

/// The numbers of the trials in the journals, in the order of their lines.
fn finished(desk: &Desk, folder: &str) -> Vec<u64> {
    let journals = folder::contents(&desk.path(folder).join("journals"));
    let lines = journals.iter().flat_map(|(_, bytes)| {
        let text = String::from_utf8_lossy(bytes).into_owned();
        let whole = text.rfind('\n').map_or(0, |end| end + 1);
        let lines = text[..whole].lines().skip(1).map(str::to_owned);
        lines.collect::<Vec<_>>()
    });
    lines.map(|line| trial_in(&line)).collect()
}

fn trial_in(line: &str) -> u64 {
    let (_, json) = line.split_once(' ').unwrap();
    let record: Value = serde_json::from_str(json).unwrap();
    record["trial"].as_u64().unwrap()
}

#[test]
fn a_plan_says_what_would_be_run_and_writes_nothing_unless_told_where() {
    let desk = desk();
    let before = folder::names(&desk.path(""));
    let said = desk.done("plan small.toml --tasks 5");
    assert!(
        said.contains("4 arms x 4 trials of 12 episodes = 16 trials"),
        "{said}"
    );
    assert!(said.contains("5 tasks of at most 4 trials"), "{said}");
    assert_eq!(folder::names(&desk.path("")), before);
    let json: Value = serde_json::from_str(&desk.done("plan small.toml --json")).unwrap();
    desk.done("run small.toml --out whole");
    assert_eq!(json["plan"], status(&desk, "whole")["plan"]);
}

#[test]
fn tasks_in_any_order_and_again_merge_to_the_bytes_of_one_process() {
    let desk = desk();
    desk.done("run small.toml --out whole");
    for tasks in [1, 3, 16] {
        let out = format!("split{tasks}");
        desk.done(&format!("plan small.toml --tasks {tasks} --out {out}"));
        for task in (1..=tasks).rev() {
            desk.done(&format!("task {out} {task} --jobs {}", 1 + task % 3));
        }
        desk.done(&format!("task {out} 1"));
        assert_eq!(
            finished(&desk, &out).len(),
            16,
            "a finished task runs nothing again"
        );
        desk.done(&format!("merge {out}"));
        let result = desk.path(&out).join("result");
        folder::assert_same(&result, &desk.path("whole"), &out);
    }
}

#[test]
fn one_process_finishes_what_tasks_began_and_tasks_what_one_process_began() {
    let desk = desk();
    desk.done("run small.toml --out whole");
    desk.done("plan small.toml --tasks 3 --out split");
    desk.done("task split 2");
    desk.done("run small.toml --out split --shard 1/2");
    desk.done("task split 1");
    desk.done("run small.toml --out split --quiet");
    let mut kept = finished(&desk, "split");
    kept.sort_unstable();
    assert_eq!(kept, (0..16).collect::<Vec<u64>>(), "a trial ran twice");
    desk.done("merge split");
    let result = desk.path("split/result");
    folder::assert_same(&result, &desk.path("whole"), "split");
}

#[test]
fn what_is_not_finished_is_not_merged_and_status_tells_the_tasks() {
    let desk = desk();
    desk.done("plan small.toml --tasks 5 --out split");
    desk.done("task split 2");
    desk.done("task split 4");
    let said = desk.done("status split");
    assert!(
        said.contains("6 of 16 trials finished, in 5 tasks"),
        "{said}"
    );
    assert!(said.contains("missing: not started (3): 1,3,5"), "{said}");
    assert!(said.contains("--array=1,3,5"), "{said}");
    let (_, said) = desk.ends("merge split", 1);
    assert!(said.contains("10 of 16 trials are missing"), "{said}");
    assert!(!desk.path("split/result").exists());
}

#[test]
fn killed_at_random_moments_a_task_keeps_what_it_finished_and_runs_none_of_it_again() {
    let desk = desk();
    desk.done("run small.toml --trials 30 --out whole");
    let mut moments = Stream::new(1, StreamName::World);
    for jobs in [1, 3] {
        let out = format!("killed{jobs}");
        desk.done(&format!(
            "plan small.toml --trials 30 --tasks 1 --out {out}"
        ));
        let words = format!("task {out} 1 --quiet --jobs {jobs}");
        let (mut known, mut interrupted) = (0, 0);
        while interrupted < 6 {
            let mut child = desk.command(&words).stderr(Stdio::null()).spawn().unwrap();
            sleep(Duration::from_millis(100 + moments.below(500) as u64));
            child.kill().unwrap();
            child.wait().unwrap();
            let kept = finished(&desk, &out).len();
            assert!(kept >= known, "{kept} are left of {known} trials");
            (known, interrupted) = (kept, interrupted + 1);
        }
        desk.done(&words);
        // No trial is in two journals: what was finished was seen by the next attempt.
        let mut kept = finished(&desk, &out);
        kept.sort_unstable();
        assert_eq!(kept, (0..120).collect::<Vec<u64>>(), "{jobs} jobs");
        desk.done(&format!("merge {out}"));
        let result = desk.path(&out).join("result");
        folder::assert_same(&result, &desk.path("whole"), &out);
    }
}

#[test]
fn a_signal_ends_a_task_in_order_with_code_75_and_the_next_attempt_goes_on() {
    let desk = desk();
    desk.done("plan small.toml --trials 100 --tasks 2 --out split");
    for name in ["USR1", "TERM"] {
        let before = finished(&desk, "split").len();
        let mut child = desk
            .command("task split 1 --jobs 1")
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        while finished(&desk, "split").len() < before + 2 {
            sleep(Duration::from_millis(5));
        }
        let pid = child.id().to_string();
        Command::new("kill")
            .args(["-s", name, &pid])
            .status()
            .unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(75), "{name}");
        let kept = status(&desk, "split")["finished"].as_u64().unwrap();
        assert_eq!(kept, finished(&desk, "split").len() as u64, "{name}");
    }
}

#[test]
fn submitted_again_is_what_is_neither_finished_nor_in_the_queue() {
    let desk = desk();
    let words = "submit small.toml --time 90m --partition short --array-limit 2 --out split";
    let (_, said) = desk.ends(words, 2);
    assert!(said.contains("such as `--tasks 100`"), "{said}");
    let said = desk.done(&format!("{words} --tasks 8"));
    assert!(
        said.contains("submitted 8 of 8 tasks as job 1 (--array=1-8)"),
        "{said}"
    );
    let script = fs::read_to_string(desk.path("split/slurm/array.sh")).unwrap();
    for line in ["--array=1-8%2", "--time=0-01:30:00", "--partition=short"] {
        assert!(
            script.contains(&format!("#SBATCH {line}\n")),
            "{line}: {script}"
        );
    }
    let here = desk.path("split").canonicalize().unwrap();
    let here = here.display();
    let asked = fs::read_to_string(desk.path("submitted")).unwrap();
    assert_eq!(
        asked,
        format!(
            "{here} --parsable slurm/array.sh\n{here} --parsable --dependency=afterok:1 \
             --kill-on-invalid-dep=yes slurm/merge.sh\n"
        )
    );
    // 1, 2 and 5 are done, 6 ended early, 3 runs, 4 waits; the last line is of another study.
    for task in [1, 2, 5] {
        desk.done(&format!("task split {task}"));
    }
    fs::write(desk.path("split/journals/00006-abc"), "").unwrap();
    let queue = format!("1 3 RUNNING {here}\n1 4 PENDING {here}\n1 7 RUNNING {here}2\n");
    fs::write(desk.path("queue"), queue).unwrap();
    let status = status(&desk, "split");
    for (key, tasks) in [
        ("complete", vec![1, 2, 5]),
        ("running", vec![3]),
        ("waiting", vec![4]),
        ("failed", vec![6]),
        ("missing", vec![7, 8]),
    ] {
        assert_eq!(status[key], serde_json::json!(tasks), "{key}: {status}");
    }
    let said = desk.done(words);
    assert!(
        said.contains("submitted 3 of 8 tasks as job 3 (--array=6-8)"),
        "{said}"
    );
    let asked = fs::read_to_string(desk.path("submitted")).unwrap();
    assert!(
        asked.contains("--dependency=afterok:3,afterany:1 "),
        "{asked}"
    );
}

#[test]
fn what_the_engine_refuses_is_told_and_a_dry_run_asks_it_nothing() {
    let desk = desk();
    let words = "submit small.toml --tasks 2 --time 1h --out split";
    let said = desk.done(&format!("{words} --dry-run"));
    assert!(said.contains("#SBATCH --array=1-2\n"), "{said}");
    assert!(!desk.path("split").exists() && !desk.path("submitted").exists());
    play(
        &desk,
        "sbatch",
        "echo 'invalid partition specified: x' >&2; exit 1",
    );
    let (_, said) = desk.ends(words, 74);
    assert_eq!(said, "error: sbatch: invalid partition specified: x\n");
    for time in ["0m", "1:00", "h", "400d"] {
        let (_, said) = desk.ends(&words.replace("1h", time), 2);
        assert!(said.contains("such as 45m, 1h or 2d"), "{time}: {said}");
    }
}

#[test]
fn another_study_another_split_and_another_program_are_refused() {
    let desk = desk();
    desk.done("plan small.toml --tasks 4 --out split");
    desk.done("plan small.toml --tasks 4 --out split");
    let (_, said) = desk.ends("plan small.toml --tasks 5 --out split", 73);
    assert!(
        said.contains("split is split into 4 tasks, not 5"),
        "{said}"
    );
    let (_, said) = desk.ends("plan small.toml --seed 8 --tasks 4 --out split", 73);
    assert!(said.contains("split contains another study"), "{said}");
    desk.ends("task split 5", 2);
    desk.ends("task nowhere 1", 66);
    let (_, said) = desk.ends("plan small.toml --tasks 17", 65);
    assert!(
        said.contains("`tasks` is 17, but must be from 1 to 16"),
        "{said}"
    );
    let plan = fs::read_to_string(desk.path("split/plan.json")).unwrap();
    fs::write(
        desk.path("split/plan.json"),
        plan.replace("\"seed\": 7", "\"seed\": 8"),
    )
    .unwrap();
    let (_, said) = desk.ends("task split 1", 65);
    assert!(
        said.contains("it was changed after it was frozen"),
        "{said}"
    );
    fs::write(
        desk.path("split/plan.json"),
        plan.replace("\"tasks\": 4", "\"tasks\": 2"),
    )
    .unwrap();
    let (_, said) = desk.ends("task split 1", 65);
    assert!(said.contains("the number of tasks was changed"), "{said}");
}

#[test]
fn a_folder_that_holds_something_else_is_refused_by_what_it_holds_and_left_as_it_is() {
    let desk = desk();
    let kinds = ["notes", "whole", "split", "search"];
    let [plan, submit, run, tune] = [
        "plan small.toml --tasks 4 --out",
        "submit small.toml --tasks 4 --time 1h --out",
        "run small.toml --force --out",
        "tune small.toml --budget 16 --out",
    ];
    fs::create_dir(desk.path("notes")).unwrap();
    fs::write(desk.path("notes/search.md"), "mine").unwrap();
    desk.done(&format!("{run} whole"));
    desk.done(&format!("{plan} split"));
    desk.done(&format!("{tune} search"));
    let before = kinds.map(|kind| folder::names(&desk.path(kind)));
    for (kind, words, refused) in [
        (
            "notes",
            "contains files that xcscr did not create",
            vec![plan, submit, run, tune],
        ),
        ("whole", "is split into 1 tasks, not 4", vec![plan, submit]),
        ("whole", "contains a study", vec![tune]),
        ("split", "contains a study", vec![tune]),
        ("search", "contains a search", vec![plan, submit, run]),
    ] {
        for command in &refused {
            let (_, said) = desk.ends(&format!("{command} {kind}"), 73);
            assert!(said.contains(words), "{command} {kind}: {said}");
        }
        if refused.contains(&submit) {
            let (_, said) = desk.ends(&format!("{submit} {kind} --dry-run"), 73);
            assert!(said.contains(words), "a dry run in {kind}: {said}");
        }
    }
    assert_eq!(kinds.map(|kind| folder::names(&desk.path(kind))), before);
}

#[test]
fn a_task_whose_journal_cannot_be_made_names_no_option_that_it_does_not_have() {
    let desk = desk();
    desk.done("plan small.toml --tasks 4 --out split");
    fs::remove_dir(desk.path("split/journals")).unwrap();
    fs::write(desk.path("split/journals"), "in the way").unwrap();
    let (_, said) = desk.ends("task split 1", 74);
    assert!(
        said.contains("journals") && !said.contains("--out"),
        "{said}"
    );
}
