//! Studies of a million trials: what they take of the memory is counted on smaller ones.

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::process::Stdio;
use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;

use crate::desk::Desk;
use crate::kit::folder;

const TASKS: usize = 7;

/// A planned study in which somebody else has finished all trials, with results that hardly two share: two of three are
/// successes.
fn planned(desk: &Desk, trials: usize) {
    let text = "name = \"s\"\nworlds = [\"maze4\"]\nmethods = [\"xcs\", \"xcscr\"]\ntrials = 1\nepisodes = 5\n";
    desk.write("s.toml", text);
    desk.done("run s.toml --out one");
    let half = trials / 2;
    desk.done(&format!(
        "plan s.toml --trials {half} --tasks {TASKS} --out planned"
    ));
    let journal = fs::read_to_string(folder::journal(&desk.path("one"))).unwrap();
    let mut lines = journal.lines();
    let header = lines.next().unwrap().split(", plan").next().unwrap();
    let (_, record) = lines.next().unwrap().split_once(' ').unwrap();
    let record: Value = serde_json::from_str(record).unwrap();
    let plan: Value = serde_json::from_str(&desk.read("planned/study.json")).unwrap();
    let plan = plan["plan"].as_str().unwrap();
    for task in 1..=TASKS {
        let path = desk.path(&format!("planned/journals/{task:05}-synthetic"));
        let mut file = BufWriter::new(File::create(path).unwrap());
        writeln!(file, "{header}, plan {plan}").unwrap();
        for trial in (task - 1..trials).step_by(TASKS) {
            let mut record = record.clone();
            record["trial"] = trial.into();
            record["result"]["Ok"]["progress"] = progress(&record, trial);
            let json = record.to_string();
            writeln!(file, "{:08x} {json}", crc32fast::hash(json.as_bytes())).unwrap();
        }
    }
}

/// The figures of a finished trial, changed to those of another one.
fn progress(record: &Value, trial: usize) -> Value {
    let mut progress = record["result"]["Ok"]["progress"].clone();
    let figures = progress.as_object_mut().unwrap();
    figures.retain(|key, _| !key.starts_with("first_") && !key.starts_with("chosen"));
    let (steps, is_success, first) = (
        5 + trial * 31 % 200,
        !trial.is_multiple_of(3),
        1 + trial % 5,
    );
    figures.insert("steps".to_owned(), steps.into());
    figures.insert("collisions".to_owned(), 0.into());
    figures.insert("optimal".to_owned(), is_success.into());
    let optimal = u32::from(is_success);
    figures.insert("optimal_episodes".to_owned(), optimal.into());
    if is_success {
        let until = steps.min(50 * first);
        figures.insert("first_optimal_episode".to_owned(), first.into());
        figures.insert("first_optimal_env_steps".to_owned(), until.into());
    }
    progress
}

/// The most memory that a command has in use, in KiB, of which the system keeps count.
fn peak(desk: &Desk, words: &str) -> u64 {
    let mut command = desk.command(words);
    let command = command.stdout(Stdio::null()).stderr(Stdio::null());
    let mut child = command.spawn().unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0;
    while child.try_wait().unwrap().is_none() {
        let text = fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kib = line.and_then(|line| line.split_whitespace().next()?.parse().ok());
        peak = kib.unwrap_or(0).max(peak);
        sleep(Duration::from_millis(1));
    }
    assert!(child.wait().unwrap().success(), "{words}");
    peak
}

#[test]
fn status_merge_and_report_of_a_million_trials_would_take_less_than_500_mb() {
    let sizes = [1_000, 5_000];
    let words = ["status planned", "merge planned", "report planned/result"];
    let peaks = sizes.map(|trials| {
        let desk = Desk::new();
        planned(&desk, trials);
        words.map(|words| peak(&desk, words))
    });
    for (i, command) in words.into_iter().enumerate() {
        let [few, many] = [peaks[0][i], peaks[1][i]];
        let bytes_per_trial = 1024 * many.saturating_sub(few) / (sizes[1] - sizes[0]) as u64;
        let million_mb = few / 1024 + bytes_per_trial;
        assert!(few > 1000, "{command}: nothing was measured");
        assert!(
            million_mb < 500,
            "{command}: {few} and {many} KiB, {million_mb} MB for a million"
        );
    }
}
