//! Whatever stands in a file or behind a flag: an error message or a result, never a panic, a
//! hang or a flood of memory. `budget.rs` counts the work.
//!
//! Each kind of input is mutated 10,000 times, those that are written to a disk less often;
//! `XCSCR_LONG=1 cargo test --test runs hostile` does so a million times.

use std::fs;
use std::path::Path;

use crate::kit::chance::{dice, rounds};
use crate::kit::folder::replace;
use crate::kit::program::{ended, expect, xcscr};
use crate::kit::trial::{maze as world, on_the_grid};
use xcscr::agent::{Knowledge, Method};
use xcscr::arena::ArenaKind;
use xcscr::episode::Observer;
use xcscr::record::reader::Recording;
use xcscr::record::{self, RecordMode, Recorder, RobotShape, RunInfo, RunKind};
use xcscr::sensor::Sensor;
use xcscr::study::{Overrides, Protocol, Shard, Study, StudyFile, StudyFolder};
use xcscr::trial::{Checkpoint, Plan, Resolved, Settings, SettingsError, Trial, seal, unseal};
use xcscr::world::Maze;
use xcscr::xcs::random::Stream;

/// What hostile files like to hold.
const PIECES: [&[u8]; 16] = [
    b"-1",
    b"1e999",
    b"1e-320",
    b"NaN",
    b"null",
    b"{",
    b"[[[[",
    b"\"",
    b"\\u0000",
    b"\0",
    b"\xff",
    b"\xef\xbb\xbf",
    b"\r\n",
    b"99999999999999999999",
    b",",
    b"-0.0",
];

/// Changes a text in one to four places: bits, bytes, pieces cut out, doubled or thrown in.
fn mutate(sound: &[u8], dice: &mut Stream) -> Vec<u8> {
    let mut bytes = sound.to_vec();
    for _ in 0..=dice.below(4) {
        let at = dice.below(bytes.len() + 1);
        let to = (at + dice.below(20)).min(bytes.len());
        match dice.below(6) {
            0 => bytes.truncate(at),
            1 => drop(bytes.drain(at..to)),
            2 => drop(bytes.splice(at..at, PIECES[dice.below(PIECES.len())].iter().copied())),
            3 => drop(bytes.splice(at..to, bytes[at..to].repeat(2))),
            4 if at < bytes.len() => bytes[at] = dice.bits() as u8,
            _ if at < bytes.len() => bytes[at] ^= 1 << dice.below(8),
            _ => {}
        }
    }
    bytes
}

/// Feeds mutants of the sound inputs to `eat`; gives how many of them it took for good ones.
fn feed(name: &str, sound: &[&[u8]], times: usize, mut eat: impl FnMut(&[u8]) -> bool) -> usize {
    let mut dice = dice(name.len() as u64);
    let mutants = (0..times).map(|number| mutate(sound[number % sound.len()], &mut dice));
    mutants.filter(|mutant| eat(mutant)).count()
}

fn plan(method: Method, arena: ArenaKind, episodes: u32) -> Plan {
    let plan = on_the_grid("maze4", method).arena(arena);
    plan.episodes(episodes)
}

fn trained(method: Method, arena: ArenaKind, episodes: u32) -> Trial {
    let mut trial = Trial::new(plan(method, arena, episodes + 1)).unwrap();
    for _ in 0..episodes {
        let _ = trial.run_episode(&mut ());
    }
    trial
}

#[test]
fn mutants_of_worlds() {
    let texts = ["maze4", "maze6", "maze4-classic", "maze5-wet"].map(|name| world(name).to_json());
    let sound: Vec<&[u8]> = texts.iter().map(String::as_bytes).collect();
    let taken = feed("worlds", &sound, rounds(10_000, 1_000_000), |text| {
        let maze = Maze::from_json(text, "mutant.json");
        // What is refused must also say why.
        maze.map_err(|error| assert!(!error.to_string().is_empty()))
            .is_ok()
    });
    assert!(taken > 0, "some mutants are worlds, too");
}

#[test]
fn mutants_of_settings() {
    let file = toml::to_string(&Settings::default()).unwrap();
    let lines: Vec<String> = file
        .split("\n\n")
        .map(|section| section.lines().take(4).collect::<Vec<_>>().join("\n"))
        .collect();
    let sound: Vec<&[u8]> = lines.iter().map(String::as_bytes).collect();
    let taken = feed("settings", &sound, rounds(10_000, 1_000_000), |text| {
        let text = String::from_utf8_lossy(text);
        let resolved = Resolved::new(&Settings::default(), &[("run.toml", &text)], &[]);
        resolved.is_ok_and(|resolved| resolved.settings.check().is_ok())
    });
    assert!(taken > 0, "some mutants are settings, too");
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
    let times = rounds(10_000, 1_000_000);
    let taken = feed("studies", &[STUDY.as_bytes()], times, |text| {
        let text = String::from_utf8_lossy(text);
        let file = StudyFile::parse(&text, "mutant.toml", Path::new("no/such/folder"));
        file.and_then(|file| Protocol::new(&file, &Overrides::default()))
            .is_ok()
    });
    assert!(taken > 0, "some mutants are studies, too");
}

#[test]
fn mutants_of_study_folders() {
    let folder = tempfile::tempdir().unwrap();
    let file = StudyFile::parse(STUDY, "small.toml", Path::new("")).unwrap();
    let few = Overrides {
        trials: Some(1),
        episodes: Some(2),
        ..Overrides::default()
    };
    let protocol = Protocol::new(&file, &few).unwrap();
    Study::new(protocol)
        .run(folder.path(), Shard::WHOLE, 1, &mut ())
        .unwrap();
    let journal = crate::kit::folder::journal(folder.path());
    for (name, path) in [
        ("plan.json", folder.path().join("plan.json")),
        ("journal", journal),
    ] {
        let sound = fs::read(&path).unwrap();
        // Each mutant is written to a disk: fewer, and more in memory above.
        let taken = feed(name, &[&sound], rounds(3_000, 30_000), |bytes| {
            replace(&path, bytes);
            StudyFolder::read(folder.path()).is_ok()
        });
        fs::write(&path, sound).unwrap();
        assert!(
            taken > 0 || name == "plan.json",
            "a journal keeps its beginning"
        );
    }
    assert!(StudyFolder::read(folder.path()).is_ok());
}

#[test]
fn mutants_of_rules() {
    let mut knowledge = trained(Method::Xcscr, ArenaKind::Grid, 1)
        .method()
        .knowledge();
    if let Knowledge::Rules(population) = &knowledge {
        let few = population.rules()[..12].to_vec();
        knowledge = Knowledge::Rules(few.try_into().unwrap());
    }
    let table = r#"{"table": {"0110": [1.5, null, -3.0, 0.25], "0111": [null, null, 0.0, 2e10]}}"#;
    let rules = serde_json::to_vec(&knowledge).unwrap();
    let percept = "0110110101101101".parse().unwrap();
    let taken = feed(
        "rules",
        &[&rules, table.as_bytes()],
        rounds(10_000, 1_000_000),
        |text| {
            let Ok(known) = serde_json::from_slice::<Knowledge>(text) else {
                return false;
            };
            let _ = known.check(16, 4);
            known.values(&percept, 4).best_actions().for_each(drop);
            true
        },
    );
    assert!(taken > 0, "some mutants are rules, too");
}

#[test]
fn every_truncation_and_every_changed_byte_of_a_checkpoint_is_detected() {
    let sound = seal(&trained(Method::Xcscr, ArenaKind::Physics, 2).checkpoint());
    assert!(unseal::<Checkpoint>(&sound).is_ok());
    for length in 0..sound.len() {
        assert!(
            unseal::<Checkpoint>(&sound[..length]).is_err(),
            "{length} bytes of it"
        );
    }
    let mut bytes = sound.clone();
    for at in 0..sound.len() {
        bytes[at] ^= 1 << (at % 8);
        assert!(unseal::<Checkpoint>(&bytes).is_err(), "byte {at}");
        bytes[at] = sound[at];
    }
    bytes.push(0);
    assert!(unseal::<Checkpoint>(&bytes).is_err(), "a byte too many");
}

#[test]
fn mutants_of_checkpoints_with_right_check_sums() {
    let mut plans = Vec::new();
    for &method in Method::ALL {
        let trial = trained(method, ArenaKind::Grid, 1);
        plans.push(postcard::to_allocvec(&trial.checkpoint()).unwrap());
    }
    let sound: Vec<&[u8]> = plans.iter().map(Vec::as_slice).collect();
    let taken = feed(
        "checkpoints",
        &sound,
        rounds(10_000, 1_000_000),
        |content| {
            let Ok(checkpoint) = postcard::from_bytes::<Checkpoint>(content) else {
                return false;
            };
            let Ok(mut trial) = Trial::resume(&checkpoint) else {
                return false;
            };
            let short = trial.method().step_threshold() <= 100;
            if short && !trial.is_finished() && trial.plan().config.arena == ArenaKind::Grid {
                let _ = trial.run_episode(&mut ());
            }
            true
        },
    );
    assert!(taken > 0, "some mutants are checkpoints, too");
}

/// A small recording.
fn recording(folder: &Path) -> Vec<u8> {
    let plan = plan(Method::Xcscr, ArenaKind::Grid, 1);
    let info = RunInfo {
        world_json: plan.maze.to_json(),
        config_json: "{}".to_owned(),
        seed: 1,
        method: "xcscr".to_owned(),
        arena: "grid".to_owned(),
        sensor: Sensor::Neighbours,
        episodes: 1,
        robot: RobotShape::for_cell(1.0),
        slip: 0.0,
        goal: 1000.0,
        kind: RunKind::Training,
    };
    let mut recorder = Recorder::create(folder, &plan.maze, info, RecordMode::All).unwrap();
    let mut trial = Trial::new(plan).unwrap();
    let observer: &mut dyn Observer = &mut recorder;
    let _ = trial.run(observer);
    recorder.finish(trial.method()).unwrap();
    fs::read(folder.join("ep-0001.mcap")).unwrap()
}

#[test]
fn mutants_of_recordings() {
    let folder = tempfile::tempdir().unwrap();
    let sound = recording(folder.path());
    let times = rounds(10_000, 1_000_000);
    let taken = feed("recordings", &[&sound], times, |bytes| {
        let recording = Recording::from_bytes(Path::new("mutant.mcap"), bytes.to_vec());
        let Ok(recording) = recording else {
            return false;
        };
        assert!(
            bytes == sound,
            "a damaged recording was taken for a sound one"
        );
        recording.messages().count() > 0
    });
    // Control: some changes change nothing, such as a byte that is replaced by itself.
    assert!(taken > 0, "a sound recording is refused");
}

#[test]
fn mutants_of_recordings_that_are_recovered() {
    let folder = tempfile::tempdir().unwrap();
    let sound = recording(folder.path());
    let (broken, saved) = (folder.path().join("broken"), folder.path().join("saved"));
    let taken = feed("salvage", &[&sound], rounds(2_000, 20_000), |bytes| {
        replace(&broken, bytes);
        record::recover(&broken, &saved, true).is_ok()
    });
    assert!(taken > 0, "most mutants hold something that can be saved");
}

/// Runs the program with so much address space, in KiB.
#[cfg(unix)]
fn within_memory(kib: u64, args: &[&str]) -> std::process::Output {
    let mut shell = std::process::Command::new("sh");
    shell
        .args(["-c", &format!("ulimit -v {kib}; exec \"$0\" \"$@\"")])
        .arg(env!("CARGO_BIN_EXE_xcscr"))
        .args(args);
    shell.output().unwrap()
}

#[cfg(unix)]
#[test]
fn ten_megabytes_of_anything_need_at_most_ten_times_their_size_and_64_mib() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large");
    let file = path.to_str().unwrap();
    for (name, piece) in [
        ("brackets", "["),
        ("objects", r#"{"rules":"#),
        ("tables", "a={"),
        ("keys", "a.b.c=1\n"),
        ("numbers", "1e308,"),
        ("rows", r#"{"rows":["","","","#),
        ("nul", "\0"),
        ("the beginning of recordings", "\u{89}MCAP0\r\n"),
    ] {
        let size = 10 << 20;
        fs::write(&path, piece.repeat(size / piece.len())).unwrap();
        let out = folder.path().join("out");
        let out = out.to_str().unwrap();
        for args in [
            &["world", "check", file][..],
            &["train", file, "--out", out],
            &["train", "worlds/maze4.json", "--config", file, "--out", out],
            &["evaluate", file, "--world", "worlds/maze4.json"],
            &["recording", "check", file],
            &["recording", "recover", file, "-o", out],
            &["study", "run", file, "--out", out],
        ] {
            let output = within_memory((10 * size as u64 + (64 << 20)) >> 10, args);
            let (_, stderr) = ended(&output, 65, &format!("{name}: {args:?}"));
            assert!(stderr.len() < 10_000, "{name}: {args:?}: a long message");
        }
    }
}

#[cfg(unix)]
#[test]
fn a_small_recording_that_unpacks_to_much_is_refused_before_it_fills_the_memory() {
    let folder = tempfile::tempdir().unwrap();
    let (bomb, out) = (
        folder.path().join("bomb.mcap"),
        folder.path().join("out.mcap"),
    );
    let options = mcap::WriteOptions::new().chunk_size(Some(1 << 30));
    let mut writer = options.create(fs::File::create(&bomb).unwrap()).unwrap();
    let channel = writer.add_channel(0, "/zeros", "json", &Default::default());
    let header = mcap::records::MessageHeader {
        channel_id: channel.unwrap(),
        sequence: 0,
        log_time: 0,
        publish_time: 0,
    };
    let zeros = vec![0; 400 << 20];
    writer.write_to_known_channel(&header, &zeros).unwrap();
    writer.finish().unwrap();
    drop(writer);
    assert!(fs::metadata(&bomb).unwrap().len() < 1 << 20, "it is small");
    let (bomb, out) = (bomb.to_str().unwrap(), out.to_str().unwrap());
    for (args, code) in [
        (&["recording", "check", bomb][..], 65),
        (&["recording", "info", bomb], 65),
        (&["recording", "recover", bomb, "-o", out], 3),
    ] {
        let output = within_memory(200 << 10, args);
        ended(&output, code, &format!("{args:?}"));
    }
}

#[cfg(unix)]
#[test]
fn what_has_no_end_is_not_read_to_its_end() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().unwrap();
    for name in ["checkpoint", "plan.json"] {
        symlink("/dev/zero", folder.path().join(name)).unwrap();
    }
    let dir = folder.path().to_str().unwrap();
    let zero = "/dev/zero";
    for args in [
        &["train", zero][..],
        &["train", "worlds/maze4.json", "--config", zero],
        &["train", "--resume", dir],
        &["evaluate", zero],
        &["recording", "info", zero],
        &["recording", "check", zero],
        &["study", "run", zero, "--out", dir],
        &["study", "status", dir],
    ] {
        let output = within_memory(2 << 20, args);
        let code = output.status.code().unwrap_or(-1);
        assert!([65, 66, 74].contains(&code), "{args:?}: {output:?}");
        ended(&output, code, &format!("{args:?}"));
    }
}

/// The values at which a number tends to be treated wrongly.
const NUMBERS: [&str; 15] = [
    "nan",
    "inf",
    "-inf",
    "-1",
    "0",
    "-0.0",
    "1",
    "1e308",
    "-1e308",
    "5e-324",
    "1e-320",
    "9223372036854775807",
    "-9223372036854775808",
    "4294967295",
    "4294967296",
];

/// The bounds that a refusal names, with their nearest neighbours outside.
fn bounds(message: &str) -> Vec<String> {
    let range = message
        .split_once("from ")
        .and_then(|(_, range)| range.split_once(" to "));
    let Some((low, high)) = range else {
        return Vec::new();
    };
    let (low, high) = (low.trim(), high.trim());
    let mut all = vec![low.to_owned(), high.to_owned()];
    if let (Ok(low), Ok(high)) = (low.parse::<f64>(), high.parse::<f64>()) {
        all.extend(
            [
                low.next_down(),
                high.next_up(),
                low.next_up(),
                high.next_down(),
            ]
            .map(|x| format!("{x:e}")),
        );
        all.extend([low - 1.0, high + 1.0].map(|x| format!("{x}")));
    }
    all
}

/// What becomes of a setting: its value is in range and finite, or the message says the range.
fn set(key: &str, value: &str) -> Result<Settings, SettingsError> {
    let resolved = Resolved::new(&Settings::default(), &[], &[format!("{key}={value}")])?;
    resolved
        .settings
        .check()
        .unwrap_or_else(|fault| panic!("{key}={value}: {fault}"));
    Ok(resolved.settings)
}

#[test]
fn every_number_among_the_settings_is_refused_beyond_its_range_and_works_at_its_bounds() {
    let defaults = Resolved::new(&Settings::default(), &[], &[]).unwrap();
    let is_number = |text: &str| text.parse::<f64>().is_ok();
    let numbers = defaults.entries().filter(|(_, value, _)| is_number(value));
    let mut tried = 0;
    for (key, ..) in numbers {
        let refusals = NUMBERS
            .map(|value| set(key, value))
            .into_iter()
            .filter_map(Result::err);
        let ranges: Vec<String> = refusals.map(|refusal| refusal.to_string()).collect();
        let with_range = ranges.iter().find(|text| text.contains("from "));
        let range = with_range.unwrap_or_else(|| panic!("{key} has no range: {ranges:?}"));
        for value in bounds(range).iter().map(String::as_str).chain(NUMBERS) {
            let Ok(mut settings) = set(key, value) else {
                continue;
            };
            tried += 1;
            // Short, or the largest step-thresholds would take minutes.
            settings.reward.step_threshold = settings.reward.step_threshold.min(20);
            for &method in users(key) {
                for &arena in arenas(key) {
                    assert_stays_finite(method, arena, &settings, &format!("{key}={value}"));
                }
            }
        }
    }
    assert!(tried > 100, "{tried} values");
}

/// The methods in which a setting matters.
fn users(key: &str) -> &'static [Method] {
    match key.split('.').next() {
        Some("plus") => &[Method::XcscrPlus],
        Some("tabular") => &[Method::SarsaLambda, Method::DynaQ, Method::RMax],
        Some("reward") => &[Method::Xcscr, Method::XcscrPlus, Method::QLearning],
        _ => &[Method::Xcscr],
    }
}

/// The arenas in which a setting matters: a learner is not told in which one it is.
fn arenas(key: &str) -> &'static [ArenaKind] {
    match key.split('.').next() {
        Some("xcs" | "plus" | "tabular" | "reward") => &[ArenaKind::Grid],
        _ => ArenaKind::ALL,
    }
}

/// The same maze, with larger cells if the robot needs them.
fn with_room_for(maze: &Maze, least_cell_m: f64) -> Maze {
    if maze.cell_size_m() >= least_cell_m {
        return maze.clone();
    }
    let mut world: serde_json::Value = serde_json::from_str(&maze.to_json()).unwrap();
    world["cell_size_m"] = least_cell_m.into();
    Maze::from_json(world.to_string().as_bytes(), "larger.json").unwrap()
}

/// Two episodes, after which no rule may hold a number that is none.
fn assert_stays_finite(method: Method, arena: ArenaKind, settings: &Settings, what: &str) {
    let mut plan = plan(method, arena, 2);
    plan.config.settings = settings.clone();
    plan.maze = with_room_for(&plan.maze, settings.physics.least_cell_m());
    let mut trial = Trial::new(plan).unwrap();
    let _ = trial.run(&mut ());
    let checkpoint: Checkpoint = unseal(&seal(&trial.checkpoint())).unwrap();
    let again = Trial::resume(&checkpoint).map(|trial| trial.checkpoint());
    assert_eq!(again.unwrap(), checkpoint, "{what}");
    if let Knowledge::Rules(population) = trial.method().knowledge() {
        for rule in population.rules() {
            let figures = [rule.prediction, rule.error, rule.fitness, rule.set_size];
            let finite = figures.iter().all(|figure| figure.is_finite());
            assert!(finite, "{what} on {}: {rule:?}", arena.name());
        }
    }
}

#[test]
fn hostile_worlds_are_refused_with_a_short_message() {
    let rows = |row: &str, count: usize| {
        format!(
            r#"{{"rows": [{}]}}"#,
            vec![format!("{row:?}"); count].join(",")
        )
    };
    let worlds = [
        ("10 MB of brackets", "[".repeat(10_000_000)),
        ("10 MB of nested objects", r#"{"rows":"#.repeat(1_250_000)),
        ("10 MB of empty rows", rows("", 3_300_000)),
        ("a row of 10 MB", rows(&".".repeat(10_000_000), 1)),
        ("10 MB of spaces", " ".repeat(10_000_000)),
        (
            "a name of 10 MB",
            format!(
                r#"{{"name": "{}", "rows": ["SG"]}}"#,
                "x".repeat(10_000_000)
            ),
        ),
        ("NaN", r#"{"cell_size_m": NaN, "rows": ["SG"]}"#.to_owned()),
        (
            "infinity",
            r#"{"cell_size_m": 1e999, "rows": ["SG"]}"#.to_owned(),
        ),
        (
            "a denormal",
            r#"{"cell_size_m": 1e-320, "rows": ["SG"]}"#.to_owned(),
        ),
        (
            "a huge number",
            format!(
                r#"{{"cell_size_m": 1{}, "rows": ["SG"]}}"#,
                "0".repeat(1_000_000)
            ),
        ),
    ];
    for (name, text) in worlds {
        let error = Maze::from_json(text.as_bytes(), "hostile.json")
            .unwrap_err()
            .to_string();
        assert!(
            error.len() < 100_000,
            "{name}: a message of {} bytes",
            error.len()
        );
    }
}

#[test]
fn rules_of_another_world_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rules.json");
    let rule = |condition: &str, action: usize| {
        format!(
            r#"{{"rules": [{{"condition": "{condition}", "action": {action}, "prediction": 1.0,
            "error": 0.0, "fitness": 0.5, "numerosity": 1, "experience": 1, "time_stamp": 1,
            "set_size": 1.0}}]}}"#
        )
    };
    let wide = "#".repeat(16);
    for (text, words) in [
        (
            rule("01#", 0),
            "looks at 3 bits, but percepts in this world have 16",
        ),
        (
            rule(&wide, 4),
            "advocates action 4, but this world has only 4 moves",
        ),
        (rule(&wide, 9), "out of range"),
        (r#"{"table": {"01": [0.5]}}"#.to_owned(), "looks at 2 bits"),
        ("[1, 2".to_owned(), "holds no rules"),
        (format!("{} x", rule(&wide, 0)), "trailing characters"),
        ("[".repeat(10_000_000), "expected value"),
    ] {
        fs::write(&path, text).unwrap();
        let args = [
            "evaluate",
            path.to_str().unwrap(),
            "--world",
            "worlds/maze4.json",
        ];
        let (_, stderr) = expect(65, &args);
        assert!(stderr.contains(words), "{words}: {stderr}");
    }
    fs::write(&path, rule(&wide, 3)).unwrap();
    let args = [
        "evaluate",
        path.to_str().unwrap(),
        "--world",
        "worlds/maze4.json",
    ];
    expect(0, &[&args[..], &["--episodes", "1"]].concat());
}

#[test]
fn nonsense_in_place_of_a_file_ends_with_a_code_that_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let nonsense = folder.path().join("nonsense");
    fs::write(&nonsense, [0xff, 0, b'\n', b'{'].repeat(1000)).unwrap();
    let name = nonsense.to_str().unwrap();
    for file in [name, folder.path().to_str().unwrap(), "no/such/file"] {
        for args in [
            &["train", file][..],
            &["train", "worlds/maze4.json", "--config", file],
            &["train", "--resume", file],
            &["evaluate", file],
            &["recording", "info", file],
            &["recording", "check", file],
            &["world", "info", file],
        ] {
            let mut command = xcscr(args);
            let output = command.arg("--json").output().unwrap();
            let code = output.status.code().unwrap();
            assert!([2, 65, 66, 73, 74].contains(&code), "{args:?}: {code}");
            ended(&output, code, &format!("{args:?}"));
        }
    }
}
