//! Studies of a million trials: what they take of the memory is counted on smaller ones.

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;
use std::process::Stdio;
use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;

use crate::kit::{folder, program};

const TASKS: usize = 7;

/// A planned study in which somebody else has finished all trials, with results that hardly two share: two of three are
/// successes.
fn planned(folder: &Path, trials: usize) -> String {
    let toml = folder.join("s.toml");
    let text = "name = \"s\"\nworlds = [\"maze4\"]\nmethods = [\"xcs\", \"xcscr\"]\ntrials = 1\nepisodes = 5\n";
    fs::write(&toml, text).unwrap();
    let (toml, out) = (toml.to_str().unwrap(), folder.join("planned"));
    let out = out.to_str().unwrap().to_owned();
    let (tasks, half) = (TASKS.to_string(), (trials / 2).to_string());
    let one = folder.join("one");
    program::expect(0, &["study", "run", toml, "--out", one.to_str().unwrap()]);
    program::expect(
        0,
        &[
            "study", "plan", toml, "--trials", &half, "--tasks", &tasks, "--out", &out,
        ],
    );
    let journal = fs::read_to_string(folder::journal(&one)).unwrap();
    let line = journal.lines().nth(1).unwrap();
    let record: Value = serde_json::from_str(line.split_once(' ').unwrap().1).unwrap();
    let plan: Value =
        serde_json::from_slice(&fs::read(folder.join("planned/plan.json")).unwrap()).unwrap();
    let header = journal
        .lines()
        .next()
        .unwrap()
        .split(", plan")
        .next()
        .unwrap();
    for task in 1..=TASKS {
        let path = folder.join(format!("planned/journals/{task:05}-synthetic"));
        let mut file = BufWriter::new(File::create(path).unwrap());
        writeln!(file, "{header}, plan {}", plan["plan"].as_str().unwrap()).unwrap();
        for trial in (task - 1..trials).step_by(TASKS) {
            let mut record = record.clone();
            record["trial"] = trial.into();
            let figures = record["result"]["Ok"]["progress"].as_object_mut().unwrap();
            let steps = 5 + trial * 31 % 200;
            figures.insert("steps".to_owned(), steps.into());
            for others in ["collisions", "optimal_episodes"] {
                figures.insert(others.to_owned(), 0.into());
            }
            for unknown in [
                "chosen",
                "chosen_before",
                "first_optimal_episode",
                "first_optimal_env_steps",
                "first_executed_optimal_episode",
            ] {
                figures.remove(unknown);
            }
            let is_success = trial % 3 > 0;
            figures.insert("optimal".to_owned(), is_success.into());
            if is_success {
                let first = 1 + trial % 5;
                let until = steps.min(50 * first);
                figures.insert("first_optimal_episode".to_owned(), first.into());
                figures.insert("first_optimal_env_steps".to_owned(), until.into());
                figures.insert("optimal_episodes".to_owned(), 1.into());
            }
            let json = record.to_string();
            writeln!(file, "{:08x} {json}", crc32fast::hash(json.as_bytes())).unwrap();
        }
    }
    out
}

/// The most memory that a command has in use, in KiB, of which the system keeps count.
fn peak(args: &[&str]) -> u64 {
    let mut command = program::xcscr(args);
    let mut child = command
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0;
    while child.try_wait().unwrap().is_none() {
        let text = fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kib = line.and_then(|line| line.split_whitespace().next()?.parse().ok());
        peak = kib.unwrap_or(0).max(peak);
        sleep(Duration::from_millis(1));
    }
    assert!(child.wait().unwrap().success(), "{args:?}");
    peak
}

#[test]
fn status_merge_and_report_of_a_million_trials_would_take_less_than_500_mb() {
    let sizes = [2_000, 8_000];
    let peaks = sizes.map(|trials| {
        let folder = tempfile::tempdir().unwrap();
        let planned = planned(folder.path(), trials);
        let result = format!("{planned}/result");
        [
            &["study", "status", &planned][..],
            &["study", "merge", &planned],
            &["study", "report", &result],
        ]
        .map(peak)
    });
    for (i, command) in ["status", "merge", "report"].into_iter().enumerate() {
        let [few, many] = [peaks[0][i], peaks[1][i]];
        let bytes_per_trial = 1024 * many.saturating_sub(few) / (sizes[1] - sizes[0]) as u64;
        let million_mb = few / 1024 + bytes_per_trial;
        println!("{command}: {few} and {many} KiB, {bytes_per_trial} bytes a trial");
        assert!(few > 1000, "{command}: nothing was measured");
        assert!(
            million_mb < 500,
            "{command}: {few} and {many} KiB, {million_mb} MB for a million"
        );
    }
}
