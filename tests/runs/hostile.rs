//! Whatever stands in a file or behind a flag: an error message or a result, never a panic, a
//! hang or a flood of memory. `budget.rs` counts the work.
//!
//! Mutants of each kind of file are the same in every run. With `XCSCR_LONG=1` the long suite tries up to
//! a million of each kind.

use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use std::slice::from_ref;

use crate::kit::desk::Desk;
use crate::kit::folder::{journal, replace};
use crate::kit::mutants::feed;
use crate::kit::trial::{Trial as Recorded, maze as world, on_the_grid};
use serde_json::{Value, json};
use xcscr::agent::{Knowledge, Method};
use xcscr::arena::ArenaKind;
use xcscr::record::RecordMode;
use xcscr::record::reader::Recording;
use xcscr::run::{RunFolder, Session};
use xcscr::study::{Agents, Protocol, Report, StudyFile, StudyFolder};
use xcscr::trial::{Config, Plan, Resolved, Settings, Trial};
use xcscr::world::Maze;

/// Mutants that are read from memory.
const IN_MEMORY: [usize; 3] = [200, 2_000, 1_000_000];
/// Mutants that are written to a disk.
const ON_DISK: [usize; 3] = [100, 500, 30_000];

fn plan(method: Method, arena: ArenaKind, episodes: u32) -> Plan {
    let plan = on_the_grid("maze4", method).arena(arena);
    plan.episodes(episodes)
}

#[test]
fn mutants_of_worlds() {
    let names = ["maze4", "maze6", "maze4-classic", "maze5-wet", "woods1"];
    let files = names.map(|name| world(name).to_json().into_bytes());
    feed(&files, IN_MEMORY, |text| {
        let maze = Maze::from_json(text, "mutant.json");
        // What is refused must also say why.
        maze.map_err(|error| assert!(!error.to_string().is_empty()))
            .is_ok_and(|maze| maze.width() > 0)
    });
}

#[test]
fn mutants_of_settings() {
    let file = toml::to_string(&Settings::default()).unwrap();
    let section = |text: &str| {
        text.lines()
            .take(4)
            .collect::<Vec<_>>()
            .join("\n")
            .into_bytes()
    };
    let files: Vec<Vec<u8>> = file.split("\n\n").map(section).collect();
    feed(&files, IN_MEMORY, |text| {
        let text = String::from_utf8_lossy(text);
        let resolved = Resolved::new(&Settings::default(), &[("run.toml", &text)], &[]);
        resolved.is_ok_and(|resolved| resolved.settings.check().is_ok())
    });
}

#[test]
fn mutants_of_the_settings_of_a_run() {
    let plan = plan(Method::XcscrPlus, ArenaKind::Grid, 2);
    let file = serde_json::to_vec(&plan.config).unwrap();
    feed(&[file], IN_MEMORY, |text| {
        let Ok(config) = serde_json::from_slice::<Config>(text) else {
            return false;
        };
        let maze = plan.maze.clone();
        // What passes its check can be begun.
        let plan = Plan { maze, config };
        plan.check().is_ok() && Trial::new(plan).is_ok()
    });
}

#[test]
fn mutants_of_unfinished_runs() {
    let desk = Desk::new();
    let run = RunFolder::create(&desk.path("run"), false).unwrap();
    let trial = Trial::new(plan(Method::Xcscr, ArenaKind::Grid, 2)).unwrap();
    drop(Session::begin(run, trial, RecordMode::None).unwrap());
    let path = desk.path("run/unfinished.json");
    let resumes = || Session::resume(RunFolder::resume(&desk.path("run")).unwrap());
    feed(&[fs::read(&path).unwrap()], ON_DISK, |bytes| {
        replace(&path, bytes);
        // A resumed run writes its plan again, and refuses another one.
        for name in ["config.json", "world.json"] {
            let _ = fs::remove_file(desk.path("run").join(name));
        }
        let resumed = resumes();
        // What is refused must also say why.
        resumed
            .map_err(|error| assert!(error.to_string().contains("run/"), "{error}"))
            .is_ok()
    });
}

const STUDY: &str = r#"
name = "small"
worlds = ["maze4", "maze5"]
methods = ["xcs", "xcscr"]
arenas = ["grid"]
trials = 4
episodes = 12
[settings]
"xcs.beta" = 0.1
[method-settings.xcscr]
reward.gamma = 0.8
[sweep]
"xcs.mu" = [0.01, 0.04]
"#;

#[test]
fn mutants_of_study_files() {
    feed(&[STUDY.into()], IN_MEMORY, |text| {
        let text = String::from_utf8_lossy(text);
        let file = StudyFile::parse(&text, "mutant.toml", Path::new("no/such/folder"));
        file.and_then(|file| Protocol::new(&file, &Agents::default()))
            .is_ok()
    });
}

/// A finished study with eight trials.
fn finished_study() -> Desk {
    let desk = Desk::new();
    let mut file = StudyFile::parse(STUDY, "small.toml", Path::new("")).unwrap();
    (file.trials, file.episodes) = (1, 2);
    let protocol = Protocol::new(&file, &Agents::default()).unwrap();
    let mut folder = StudyFolder::open(desk.folder(), protocol, false).unwrap();
    folder
        .run(1, &mut |_, _| ControlFlow::Continue(()))
        .unwrap();
    desk
}

/// Reads a study. If it is complete, makes the report of every twentieth one, which takes a while.
fn is_read(folder: &Path, number: Option<u32>) -> bool {
    let Ok(folder) = StudyFolder::read(folder) else {
        return false;
    };
    if number.unwrap().is_multiple_of(20) && folder.require_complete().is_ok() {
        assert!(!Report::new(&folder).terminal().is_empty());
    }
    true
}

/// Returns the checksum of a text, as it stands in the files of a study.
fn sum(text: &str) -> String {
    format!("{:08x}", crc32fast::hash(text.as_bytes()))
}

#[test]
fn mutants_of_plans_and_journals() {
    let (desk, mut numbers) = (finished_study(), 0..);
    // A journal whose end is missing is that of a study that was killed.
    let path = journal(desk.folder());
    let valid = fs::read(&path).unwrap();
    feed(from_ref(&valid), ON_DISK, |bytes| {
        replace(&path, bytes);
        is_read(desk.folder(), numbers.next())
    });
    replace(&path, valid);
    // The checksum of a plan refuses nearly all of its mutants.
    let (path, valid) = (desk.path("study.json"), desk.read("study.json"));
    feed(from_ref(&valid), ON_DISK, |bytes| {
        replace(&path, bytes);
        is_read(desk.folder(), numbers.next());
        true
    });
    replace(&path, valid);
    assert!(is_read(desk.folder(), Some(0)), "control");
}

#[test]
fn mutants_of_journals_with_right_checksums() {
    let (desk, mut numbers) = (finished_study(), 0..);
    let path = journal(desk.folder());
    let text = fs::read_to_string(&path).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let [head, trial] = [lines[0], &lines[1][9..]];
    let rest = lines[2..].join("\n");
    feed(&[trial.into()], ON_DISK, |json| {
        let json = String::from_utf8_lossy(json).replace('\n', " ");
        replace(&path, format!("{head}\n{} {json}\n{rest}\n", sum(&json)));
        is_read(desk.folder(), numbers.next())
    });
}

#[test]
fn mutants_of_plans_with_right_checksums() {
    let (desk, mut numbers) = (finished_study(), 0..);
    let path = desk.path("study.json");
    let valid: Value = serde_json::from_slice(&desk.read("study.json")).unwrap();
    let file = json!({ "study": valid["study"], "tasks": valid["tasks"], "arms": valid["arms"] });
    feed(&[file.to_string().into()], ON_DISK, |text| {
        let Ok(mut file) = serde_json::from_slice::<Value>(text) else {
            return false;
        };
        let study = file["study"].to_string();
        let plan = sum(&study);
        let arms = file["arms"].as_array().into_iter().flatten();
        let arms: Vec<&str> = arms.filter_map(Value::as_str).collect();
        let words = format!("{plan} in {} tasks: {}", file["tasks"], arms.join(", "));
        if let Some(file) = file.as_object_mut() {
            file.remove("study");
            file.insert("plan".to_owned(), json!(plan));
            file.insert("checksum".to_owned(), json!(sum(&words)));
        }
        // The study is the last field, as the program writes it.
        let rest = file.to_string();
        replace(
            &path,
            format!("{},\"study\":{study}}}", rest.trim_end_matches('}')),
        );
        is_read(desk.folder(), numbers.next())
    });
}

/// What was learned in one episode.
fn learned(method: Method) -> Vec<u8> {
    let plan = plan(method, ArenaKind::Grid, 1);
    let mut known = serde_json::to_value(plan.run().unwrap().method().knowledge()).unwrap();
    shorten(&mut known);
    serde_json::to_vec(&known).unwrap()
}

/// Leaves at most six of each list: mutants of a short document reach more of it.
fn shorten(value: &mut Value) {
    match value {
        Value::Array(items) => {
            items.truncate(6);
            items.iter_mut().for_each(shorten);
        }
        Value::Object(fields) => fields.values_mut().for_each(shorten),
        _ => {}
    }
}

#[test]
fn mutants_of_rules() {
    let files = [Method::Xcscr, Method::XcscrPlus, Method::QLearning].map(learned);
    let percept = "0110110101101101".parse().unwrap();
    let mut number = 0;
    feed(&files, [400, 8_000, 1_000_000], |text| {
        let Ok(known) = serde_json::from_slice::<Knowledge>(text) else {
            return false;
        };
        number += 1;
        known.values(&percept, 4).best_actions().for_each(drop);
        let mut plan = plan(Method::XcscrPlus, ArenaKind::Grid, 1);
        let fits = known.check(plan.config.sensor, &plan.maze).is_ok();
        if fits && number % 20 == 0 {
            // What is accepted can be begun with.
            plan.config.initial = Some(known);
            let _ = plan.run();
        }
        true
    });
}

/// A small recording.
fn recording(desk: &Desk) -> Vec<u8> {
    let trial = Recorded {
        episodes: 1,
        ..Recorded::default()
    };
    fs::read(&trial.record(desk.folder()).unwrap().files[0]).unwrap()
}

#[test]
fn mutants_of_recordings() {
    let valid = recording(&Desk::new());
    // Only a mutant that changes nothing is accepted, so that few would not do.
    feed(from_ref(&valid), [2_000, 2_000, 1_000_000], |bytes| {
        let recording = Recording::from_bytes(Path::new("mutant.mcap"), bytes.to_vec());
        let Ok(recording) = recording else {
            return false;
        };
        assert!(bytes == valid, "a damaged recording was accepted");
        // Some changes change nothing, such as a byte that is replaced by itself.
        recording.messages().count() > 0
    });
}
