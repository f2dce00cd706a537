//! Files that are well formed and carry the right checksums, and say what no program ever wrote:
//! a sound file, changed field by field, so that the mutants reach what lies behind the checksum.
//!
//! Each kind of file is mutated at least 10,000 times; `XCSCR_LONG=1 cargo test --test runs forged`
//! does so ten times as often.

use std::fs;
use std::path::Path;

use crate::kit::chance::{dice, rounds};
use crate::kit::folder::{journal, replace};
use serde_json::{Value, json};
use xcscr::agent::{Estimator, Knowledge, Method};
use xcscr::arena::ArenaKind;
use xcscr::study::{Overrides, Protocol, Report, Shard, Study, StudyFile, StudyFolder};
use xcscr::trial::{Config, Plan, Trial};
use xcscr::world::Maze;
use xcscr::xcs::random::Stream;

/// What no field likes to be.
fn odd(dice: &mut Stream) -> Value {
    let odd = [
        json!(null),
        json!(true),
        json!(false),
        json!(0),
        json!(1),
        json!(-1),
        json!(2),
        json!(13),
        json!(u32::MAX),
        json!(u64::from(u32::MAX) + 1),
        json!(u64::MAX),
        json!(i64::MIN),
        json!(0.5),
        json!(-0.0),
        json!(1e308),
        json!(5e-324),
        json!(""),
        json!("\u{1b}[31mred"),
        json!("0".repeat(70)),
        json!([]),
        json!({}),
    ];
    odd[dice.below(odd.len())].clone()
}

/// Every value below this one, by its place.
fn places(value: &Value, path: &mut Vec<usize>, all: &mut Vec<Vec<usize>>) {
    all.push(path.clone());
    let below: Vec<&Value> = match value {
        Value::Array(items) => items.iter().collect(),
        Value::Object(fields) => fields.values().collect(),
        _ => Vec::new(),
    };
    for (i, item) in below.into_iter().enumerate() {
        path.push(i);
        places(item, path, all);
        path.pop();
    }
}

fn at<'a>(value: &'a mut Value, path: &[usize]) -> &'a mut Value {
    let Some((&first, rest)) = path.split_first() else {
        return value;
    };
    let below = match value {
        Value::Array(items) => items.get_mut(first),
        Value::Object(fields) => fields.values_mut().nth(first),
        _ => None,
    };
    at(below.expect("places exist"), rest)
}

/// Changes one to three values of a document: to something odd, to another value of the same
/// document, by one, or away.
fn forge(sound: &Value, dice: &mut Stream) -> Value {
    let mut forged = sound.clone();
    for _ in 0..=dice.below(3) {
        let mut all = Vec::new();
        places(&forged, &mut Vec::new(), &mut all);
        let other = at(&mut forged.clone(), &all[dice.below(all.len())]).clone();
        let place = at(&mut forged, &all[dice.below(all.len())]);
        match (dice.below(6), &mut *place) {
            (0, Value::Array(items)) if !items.is_empty() => drop(items.pop()),
            (1, Value::Array(items)) if !items.is_empty() => items.push(items[0].clone()),
            (0, Value::Object(fields)) => {
                let name = fields.keys().nth(dice.below(fields.len().max(1))).cloned();
                name.map(|name| fields.remove(&name));
            }
            (1 | 2, Value::Number(number)) => {
                let up = if dice.below(2) == 0 { 1.0 } else { -1.0 };
                *place = match (number.as_u64(), number.as_f64()) {
                    (Some(number), _) if up > 0.0 => json!(number.saturating_add(1)),
                    (Some(number), _) => json!(number.saturating_sub(1)),
                    (_, number) => json!(number.unwrap_or(0.0) + up),
                };
            }
            (3, _) => *place = other,
            _ => *place = odd(dice),
        }
    }
    forged
}

const STUDY: &str = r#"
name = "small"
worlds = ["maze4"]
methods = ["xcs", "q-learning"]
trials = 2
episodes = 12
"#;

/// A finished study.
fn study(folder: &Path) {
    let file = StudyFile::parse(STUDY, "small.toml", Path::new("")).unwrap();
    let protocol = Protocol::new(&file, &Overrides::default()).unwrap();
    Study::new(protocol.clone())
        .run(folder, Shard::WHOLE, 1, &mut ())
        .unwrap();
}

/// Reads a study and makes its report, if it can be read; says whether it could.
fn report(folder: &Path) -> bool {
    let Ok(folder) = StudyFolder::read(folder) else {
        return false;
    };
    if folder.require_complete().is_ok() {
        assert!(!Report::new(&folder).terminal().is_empty());
    }
    true
}

#[test]
fn forged_journals() {
    let folder = tempfile::tempdir().unwrap();
    study(folder.path());
    let path = journal(folder.path());
    let text = fs::read_to_string(&path).unwrap();
    let sound: Vec<&str> = text.lines().collect();
    let mut dice = dice(11);
    let mut taken = 0;
    for number in 0..rounds(10_000, 100_000) {
        let mut lines: Vec<String> = sound.iter().map(|&line| line.to_owned()).collect();
        let at = 1 + dice.below(lines.len() - 1);
        let record: Value = serde_json::from_str(&lines[at][9..]).unwrap();
        let json = forge(&record, &mut dice).to_string();
        lines[at] = format!("{:08x} {json}", crc32fast::hash(json.as_bytes()));
        replace(&path, lines.join("\n") + "\n");
        // All mutants are read; drawing the conclusions of each would take minutes.
        let is_read = match number % 20 {
            0 => report(folder.path()),
            _ => StudyFolder::read(folder.path()).is_ok(),
        };
        taken += usize::from(is_read);
    }
    // Control: a few steps more or less are possible.
    assert!(taken > 0, "every forged journal was refused");
    fs::write(&path, &text).unwrap();
    assert!(report(folder.path()), "the sound one was refused");
}

#[test]
fn forged_plans() {
    let folder = tempfile::tempdir().unwrap();
    study(folder.path());
    let (path, journal) = (folder.path().join("plan.json"), journal(folder.path()));
    let sound: Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    let lines = fs::read_to_string(&journal).unwrap();
    let records = lines.split_once('\n').unwrap().1;
    let mut dice = dice(12);
    let (mut taken, mut split) = (0, 0);
    for number in 0..rounds(10_000, 100_000) {
        let study = forge(&sound["study"], &mut dice).to_string();
        let plan = format!("{:08x}", crc32fast::hash(study.as_bytes()));
        let mut rest = json!({ "tasks": sound["tasks"] });
        // Half of them say another number of tasks, too.
        if number % 2 == 0 {
            rest = forge(&rest, &mut dice);
        }
        if let Some(rest) = rest.as_object_mut() {
            let tasks = rest.get("tasks").map(Value::to_string).unwrap_or_default();
            let words = format!("{plan} in {tasks} tasks");
            let sum = format!("{:08x}", crc32fast::hash(words.as_bytes()));
            rest.extend([
                ("plan".to_owned(), json!(plan)),
                ("checksum".to_owned(), json!(sum)),
            ]);
        }
        let rest = rest.to_string();
        let text = format!("{},\"study\":{study}}}", rest.trim_end_matches('}'));
        replace(&path, text);
        let header = format!("xcscr study journal 3, plan {plan}\n");
        replace(&journal, header + records);
        let is_read = match number % 20 {
            0 => report(folder.path()),
            _ => StudyFolder::read(folder.path()).is_ok(),
        };
        taken += usize::from(is_read);
        split += usize::from(is_read && !rest.contains("\"tasks\":1}"));
    }
    // Control: another seed, another value of a setting, or another number of tasks, is a study, too.
    assert!(taken > 0 && split > 0, "every forged plan was refused");
}

/// What was learned in one episode, as little as it is, and what is predicted.
fn learned((method, map): (Method, bool)) -> Value {
    let maze = Maze::load(Path::new("worlds/maze4.json")).unwrap();
    let mut plan = Plan::new(maze).method(method).arena(ArenaKind::Grid);
    if map {
        plan.config.settings.plus.estimator = Estimator::Map;
    }
    let trial = plan.episodes(1).run().unwrap();
    let mut known = serde_json::to_value(trial.method().knowledge()).unwrap();
    // The parts of a map must be as many as each other.
    if !map {
        shorten(&mut known);
    }
    known
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
fn forged_rules() {
    let methods = [
        (Method::Xcscr, false),
        (Method::XcscrPlus, false),
        (Method::XcscrPlus, true),
        (Method::QLearning, false),
        (Method::RMax, true),
    ];
    let sound = methods.map(learned);
    let percept = "0110110101101101".parse().unwrap();
    let mut dice = dice(14);
    let mut taken = 0;
    for number in 0..rounds(40_000, 400_000) {
        let forged = forge(&sound[number % sound.len()], &mut dice);
        let text = forged.to_string();
        let Ok(known) = serde_json::from_str::<Knowledge>(&text) else {
            continue;
        };
        taken += 1;
        let _ = known.values(&percept, 4).best_actions().count();
        if known.check(16, 4).is_ok() && number % 20 == 0 {
            // What is accepted can be begun with.
            let maze = Maze::load(Path::new("worlds/maze4.json")).unwrap();
            let mut plan = Plan::new(maze).arena(ArenaKind::Grid).episodes(1);
            plan.config.initial = Some(known);
            let _ = plan.run();
        }
    }
    assert!(taken > 0, "every forged file of rules was refused");
}

#[test]
fn forged_worlds() {
    let read = |name: &str| {
        let bytes = fs::read(format!("worlds/{name}.json")).unwrap();
        serde_json::from_slice::<Value>(&bytes).unwrap()
    };
    let sound = ["maze4", "woods1", "maze6"].map(read);
    let mut dice = dice(15);
    let mut taken = 0;
    for number in 0..rounds(10_000, 100_000) {
        let forged = forge(&sound[number % sound.len()], &mut dice).to_string();
        match Maze::from_json(forged.as_bytes(), "forged.json") {
            Ok(maze) => taken += usize::from(maze.width() > 0),
            Err(fault) => assert!(!fault.to_string().is_empty()),
        }
    }
    assert!(taken > 0, "every forged world was refused");
}

#[test]
fn forged_settings_of_a_run() {
    let maze = Maze::load(Path::new("worlds/maze4.json")).unwrap();
    let plan = Plan::new(maze).arena(ArenaKind::Grid);
    let sound = serde_json::to_value(&plan.config).unwrap();
    let mut dice = dice(16);
    let mut taken = 0;
    for _ in 0..rounds(10_000, 100_000) {
        let forged = forge(&sound, &mut dice);
        let Ok(config) = serde_json::from_value::<Config>(forged) else {
            continue;
        };
        let maze = plan.maze.clone();
        // What passes its check can be begun.
        let plan = Plan { maze, config };
        taken += usize::from(plan.check().is_ok() && Trial::new(plan).is_ok());
    }
    assert!(taken > 0, "all forged settings were refused");
}
