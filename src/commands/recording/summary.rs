//! `xcscr recording info RUN`: summarises a run on one screen.

use std::fs;
use std::path::{Path, PathBuf};

use xcscr::disk;
use xcscr::record::reader::Recording;
use xcscr::record::{RecordingKind, RunKind};

use crate::commands::failure::Failure;
use crate::commands::results::Results;
use crate::commands::terminal::write_row;

/// The number of episodes at the beginning and at the end that are compared.
const FEW: usize = 10;

/// Returns the finished recording of the whole run if `path` is the folder of a run.
pub fn whole_run(path: &Path) -> Option<PathBuf> {
    let run = path.join(RecordingKind::Run.file_name());
    (path.is_dir() && run.is_file()).then_some(run)
}

/// Summarises the run in a folder with the recordings `files`.
pub fn print(
    folder: &Path,
    run: &Path,
    files: &[PathBuf],
    out: &mut Results,
) -> Result<(), Failure> {
    let recording = Recording::open(run)?;
    let episodes = recording.episodes()?;
    let kind = recording.run_kind()?;
    let entry = |key: &str| recording.metadata("run").and_then(|run| run.get(key));
    let [world, method, arena, sensor, seed] =
        ["world", "method", "arena", "sensor", "seed"].map(|key| entry(key).map_or("?", |e| e));
    let of = match kind {
        RunKind::Evaluation => "evaluation of ",
        RunKind::Training | RunKind::External => "",
    };
    writeln!(
        out,
        "{world}: {of}{method} on {arena}, {sensor}, seed {seed}, {} episodes",
        episodes.len()
    )?;
    let goals = episodes.iter().filter(|one| one.outcome == "goal");
    let goals: Vec<u32> = goals.map(|one| one.episode).collect();
    let all = episodes.iter();
    let steps: Vec<u32> = all.map(|one| one.steps).collect();
    let all = episodes.iter();
    let collisions: Vec<u32> = all.map(|one| one.collisions).collect();
    // The policy and the number of rules change only in a training.
    if kind == RunKind::Training {
        let optimal = episodes.iter().filter(|one| one.optimal);
        let optimal: Vec<u32> = optimal.map(|one| one.episode).collect();
        write_row(out, "reached the goal", times(&goals, episodes.len()))?;
        write_row(out, "policy optimal", times(&optimal, episodes.len()))?;
        write_row(out, "steps", change(&steps))?;
        write_row(out, "collisions", change(&collisions))?;
    } else {
        let goals = format!("in {} of {}", goals.len(), episodes.len());
        write_row(out, "reached the goal", goals)?;
        write_row(out, "steps", spread(&steps))?;
        write_row(out, "collisions", spread(&collisions))?;
    }
    if let Some(last) = episodes.last().filter(|_| kind == RunKind::Training) {
        let shortest = last
            .shortest
            .map_or("unknown".to_owned(), |few| format!("{few} steps"));
        write_row(out, "shortest path", shortest)?;
        let rules = format!("{} at the end", last.rules);
        write_row(out, "rules", rules)?;
    }
    print_files(folder, run, files, out)
}

fn print_files(
    folder: &Path,
    run: &Path,
    files: &[PathBuf],
    out: &mut Results,
) -> Result<(), Failure> {
    let sizes = files.iter().filter_map(|file| fs::metadata(file).ok());
    let megabytes = sizes.map(|data| data.len()).sum::<u64>() as f64 / 1e6;
    let (typed, run) = (disk::typed(folder), disk::typed(run));
    writeln!(out, "{} recordings, {megabytes:.1} MB", files.len())?;
    for (what, command) in [
        ("watch them", format!("replay {typed}")),
        ("inspect one", format!("recording info {run}")),
        ("verify", format!("recording verify {typed}")),
    ] {
        write_row(out, what, format!("xcscr {command}"))?;
    }
    Ok(())
}

/// Formats the number of some of all episodes, and which was the first.
fn times(some: &[u32], all: usize) -> String {
    some.first().map_or("never".to_owned(), |first| {
        let count = some.len();
        format!("in {count} of {all}, first in episode {first}")
    })
}

/// Returns the mean of numbers; 0 if there are none.
fn mean(numbers: &[u32]) -> f64 {
    let sum: u64 = numbers.iter().copied().map(u64::from).sum();
    sum as f64 / numbers.len().max(1) as f64
}

/// Formats the mean, the least and the greatest number.
fn spread(numbers: &[u32]) -> String {
    let mean = mean(numbers);
    let (least, most) = (numbers.iter().min(), numbers.iter().max());
    let (least, most) = (least.unwrap_or(&0), most.unwrap_or(&0));
    format!("mean {mean:.1} per episode, from {least} to {most}")
}

/// Formats the means at the beginning and at the end.
fn change(numbers: &[u32]) -> String {
    let few = FEW.min(numbers.len());
    let (first, last) = (&numbers[..few], &numbers[numbers.len() - few..]);
    let (before, after) = (mean(first), mean(last));
    format!("mean {before:.1} in the first {few} episodes, {after:.1} in the last")
}
