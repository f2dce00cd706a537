//! Runs of the program that were stopped: killed at any moment, interrupted, or changed by hand.
//!
//! With `XCSCR_LONG=1` the long suite kills 200 times.

use std::fs;
use std::path::Path;

use crate::kit::chance::{dice, rounds};
use crate::kit::desk::Desk;
use crate::kit::folder::{assert_same, contents};
use crate::kit::program::{ended, output_of, signal, wait_for, wait_until};
use crate::kit::trial::on_the_grid;
use xcscr::agent::Method;
use xcscr::record::{self, RecordMode};
use xcscr::run::{RunFolder, Session};
use xcscr::trial::{Plan, Trial};
use xcscr::xcs::random::Stream;

/// A short trial on the grid.
fn plan() -> Plan {
    on_the_grid("maze4", Method::Xcscr).episodes(5).seed(3)
}

/// Every recording that has its final name is whole.
fn assert_sound(folder: &Path, what: &str) -> usize {
    let recordings = contents(folder).into_iter().map(|(name, _)| name);
    let whole: Vec<String> = recordings.filter(|name| name.ends_with(".mcap")).collect();
    for name in &whole {
        let findings = record::check(&folder.join(name)).unwrap();
        assert!(findings.is_empty(), "{what}: {name}: {findings:?}");
    }
    whole.iter().filter(|name| name.starts_with("ep-")).count()
}

/// The episodes of the run that is killed.
const KILLED_EPISODES: usize = 30;

/// Trains into `run`, and is stopped by signals when random episodes are recorded, until it ends by
/// itself. Gives what it prints then.
fn train_with_kills(desk: &Desk, begin: &str, dice: &mut Stream) -> (String, String) {
    let out = desk.path("run");
    let is_there = |name: &str| out.join(name).is_file();
    let mut history = String::new();
    let mut before = 0;
    for attempt in 0..5 {
        // A kill can come after the run is done, but before it has said so.
        let mut child = match is_there("unfinished.json") || is_there("rules.json") {
            true => desk.spawn("train --resume @run --json"),
            false => desk.spawn(begin),
        };
        let until = before + dice.below(KILLED_EPISODES - before + 1);
        let name = *dice
            .choose(&["KILL", "KILL", "TERM", "INT", "USR1"])
            .unwrap();
        if attempt < 4 {
            let episode = format!("ep-{until:04}.mcap");
            wait_until("an episode or the end", || {
                until == 0 || is_there(&episode) || child.try_wait().unwrap().is_some()
            });
            if child.try_wait().unwrap().is_none() {
                signal(&child, name);
            }
        }
        history += &format!("{name} in episode {until}; ");
        let output = output_of(child);
        if output.status.success() {
            return (history, ended(&output, 0, "").0);
        }
        if output.status.code() == Some(75) {
            ended(&output, 75, &history);
        }
        if out.is_dir() {
            let now = assert_sound(&out, &history);
            assert!(now >= before, "{history}: {before} episodes, then {now}");
            before = now;
        }
    }
    panic!("{history}: never ended");
}

#[test]
fn a_run_killed_at_random_moments_loses_no_finished_episode_and_ends_in_the_same_bytes() {
    let desk = Desk::new();
    let args =
        format!("train maze4 --arena grid --seed 5 --episodes {KILLED_EPISODES} --out @run --json");
    let wanted_json = desk.ok(&args);
    let wanted = desk.path("wanted");
    fs::rename(desk.path("run"), &wanted).unwrap();
    let mut dice = dice(11);
    let (mut kills, mut round) = (0, 0);
    // A signal that comes too late proves nothing, and does not count.
    while kills < rounds([1, 10, 200]) {
        round += 1;
        let (history, json) = train_with_kills(&desk, &args, &mut dice);
        let what = format!("round {round}: {history}");
        assert_same(&desk.path("run"), &wanted, &what);
        if !json.contains("\"finished\": true") {
            assert_eq!(json, wanted_json, "{what}");
        }
        fs::remove_dir_all(desk.path("run")).unwrap();
        let stops = history.trim_end_matches("; ").rsplit_once("; ");
        kills += stops.map_or(0, |(stops, _)| stops.matches("KILL").count());
    }
}

/// Stops a training with a signal after three episodes. Gives stderr.
fn interrupted(desk: &Desk, line: &str) -> String {
    let child = desk.spawn(line);
    wait_for(&desk.path("run/ep-0003.mcap"));
    signal(&child, "TERM");
    ended(&output_of(child), 75, "TERM").1
}

#[test]
fn an_interrupted_run_is_named_and_a_finished_one_is_left_alone() {
    let desk = Desk::new();
    let begin = "train maze4 --episodes 100 --out @run";
    let stderr = interrupted(&desk, begin);
    let hint = format!("`xcscr train --resume {}`", desk.name("run"));
    assert!(stderr.contains(&hint), "{stderr}");
    desk.fails(65, "recording info @run", &hint);
    let before = contents(&desk.path("run"));
    let stderr = desk.fails(73, begin, "interrupted run");
    assert!(stderr.contains(&hint), "{stderr}");
    let after = contents(&desk.path("run"));
    assert!(after == before, "a refusal changed the folder");
    desk.ok("train --resume @run --json");
    let before = contents(&desk.path("run"));
    let stdout = desk.ok("train --resume @run");
    assert!(stdout.contains("is finished: all 100 episodes"), "{stdout}");
    assert_eq!(desk.json("train --resume @run --json")["finished"], true);
    let after = contents(&desk.path("run"));
    assert!(after == before, "a finished run was changed");
}

/// Changes the folder of an interrupted run and resumes it. Gives code and stderr.
fn resuming_after(change: impl Fn(&Path)) -> (i32, String) {
    let desk = Desk::new();
    let run = RunFolder::create(&desk.path("run"), true).unwrap();
    let session = Session::begin(run, Trial::new(plan()).unwrap(), RecordMode::All).unwrap();
    assert!(session.run(&mut (), &|| true).is_err());
    change(&desk.path("run"));
    let before = contents(&desk.path("run"));
    let output = desk.output("train --quiet --resume @run");
    let code = output.status.code().unwrap();
    let is_kept = contents(&desk.path("run")) == before;
    assert!(code == 0 || is_kept, "a refusal changed the folder");
    (code, ended(&output, code, "resume").1)
}

/// A change of a folder, and the exit code and words of resuming there.
type Case<'a> = (&'a dyn Fn(&Path), i32, &'a str);

#[test]
fn a_run_is_resumed_only_from_the_files_that_it_left() {
    fn edit(folder: &Path, name: &str, from: &str, to: &str) {
        let path = folder.join(name);
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.contains(from), "{text}");
        fs::write(path, text.replacen(from, to, 1)).unwrap();
    }
    fn put(folder: &Path, name: &str) {
        fs::write(folder.join(name), "mine").unwrap();
    }
    fn remove(folder: &Path, name: &str) {
        fs::remove_file(folder.join(name)).unwrap();
    }
    let (settings, world) = ("config.json", "world.json");
    let unfinished = "unfinished.json";
    let cases: [Case<'_>; 12] = [
        (&|_| {}, 0, ""),
        // A file that is removed is written again.
        (&|run| remove(run, settings), 0, ""),
        (
            &|run| edit(run, settings, "\"episodes\": 5", "\"episodes\": 9"),
            65,
            "config.json was changed",
        ),
        (
            &|run| edit(run, world, "S", "."),
            65,
            "world.json was changed",
        ),
        // A name that no run uses.
        (&|run| put(run, "notes.mcap"), 0, ""),
        (
            &|run| put(run, "ep-0003.mcap"),
            73,
            "ep-0003.mcap is not a file of this run",
        ),
        (
            &|run| put(run, "rules.json"),
            73,
            "rules.json is not a file of this run",
        ),
        // The recording of the run is made anew.
        (&|run| remove(run, "run.mcap.part"), 0, ""),
        (&|run| remove(run, "ep-0001.mcap"), 0, ""),
        (
            &|run| edit(run, unfinished, "\"seed\": 3", "\"seed\": 4"),
            65,
            "config.json was changed",
        ),
        (
            &|run| edit(run, unfinished, env!("CARGO_PKG_VERSION"), "0.0.9"),
            65,
            "begun by version 0.0.9",
        ),
        (
            &|run| put(run, unfinished),
            65,
            "unfinished.json: expected value",
        ),
    ];
    for (change, code, words) in cases {
        let (found, stderr) = resuming_after(change);
        assert_eq!(found, code, "{words}: {stderr}");
        assert!(stderr.contains(words), "{words}: {stderr}");
    }
}
