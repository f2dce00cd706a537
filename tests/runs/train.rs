//! `train`, `evaluate`, `replay` and `check` as their users call them.

use std::fs;
use std::path::Path;

use crate::kit::folder::contents;
use crate::kit::program::expect;
use crate::kit::trial::maze;
use serde_json::Value;
use xcscr::agent::Method;
use xcscr::arena::ArenaKind;
use xcscr::sensor::Sensor;
use xcscr::trial::{Plan, Settings, Trial};

#[track_caller]
fn json(args: &[&str]) -> Value {
    serde_json::from_str(&expect(0, args).0).unwrap()
}

/// Trains into `folder`, with more arguments if wanted.
#[track_caller]
fn train(folder: &Path, world: &str, more: &[&str]) -> Value {
    let world = format!("worlds/{world}.json");
    let out = folder.to_str().unwrap();
    json(&[&["train", &world, "--out", out, "--json"], more].concat())
}

#[test]
fn train_learns_maze4_in_physics_and_says_so_in_json() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    let report = train(&run, "maze4", &[]);
    for (field, expected) in [
        ("world", "maze4".into()),
        ("method", "xcscr-plus".into()),
        ("arena", "physics".into()),
        ("sensor", "lidar".into()),
        ("seed", Value::from(1)),
        ("episodes", 180.into()),
        ("optimal_steps", 10.into()),
        ("optimal_paths", 3.into()),
        ("greedy_steps", 10.into()),
        ("retained", true.into()),
        ("run_dir", run.to_str().unwrap().into()),
    ] {
        assert_eq!(report[field], expected, "{field} in {report}");
    }
    for field in [
        "first_optimal_episode",
        "first_optimal_env_steps",
        "steps",
        "collisions",
        "rules",
    ] {
        assert!(report[field].as_u64().unwrap() > 0, "{field} in {report}");
    }
    let names: Vec<String> = contents(&run).into_iter().map(|(name, _)| name).collect();
    assert_eq!(
        names.iter().filter(|name| name.starts_with("ep-")).count(),
        180,
        "{names:?}"
    );
    for name in ["config.json", "rules.json", "run.mcap", "world.json"] {
        assert!(names.iter().any(|n| n == name), "{name} in {names:?}");
    }
}

#[test]
fn the_percept_is_sensed_in_physics_and_looked_up_on_the_grid_unless_it_is_chosen() {
    let folder = tempfile::tempdir().unwrap();
    for (arena, chosen, wanted) in [
        ("physics", None, "lidar"),
        ("grid", None, "neighbours"),
        ("physics", Some("neighbours"), "neighbours"),
        ("grid", Some("lidar"), "lidar"),
    ] {
        let run = folder.path().join(format!("{arena}-{chosen:?}"));
        let mut more = vec!["--arena", arena, "--episodes", "2"];
        more.extend(chosen.iter().flat_map(|name| ["--sensor", name]));
        assert_eq!(train(&run, "maze4", &more)["sensor"], wanted, "{arena}");
    }
}

/// How many messages of each topic the episodes of a run have.
fn messages(run: &Path, topic: &str) -> Vec<u64> {
    let episodes = ["ep-0001.mcap", "ep-0002.mcap"].map(|name| run.join(name));
    let shown = episodes.map(|file| json(&["recording", "info", file.to_str().unwrap(), "--json"]));
    let of_topic = |shown: &Value| {
        let topics = shown[0]["topics"].as_array().unwrap().iter();
        let found = topics.filter(|entry| entry["name"] == topic);
        found.map(|entry| entry["messages"].as_u64().unwrap()).sum()
    };
    shown.iter().map(of_topic).collect()
}

#[test]
fn beams_are_recorded_when_they_are_asked_for_and_are_the_same_in_a_new_run() {
    let folder = tempfile::tempdir().unwrap();
    let [with, without] = ["beams", "all"].map(|mode| {
        let run = folder.path().join(mode);
        train(&run, "maze4", &["--episodes", "2", "--record", mode]);
        run
    });
    let steps = messages(&with, "/step");
    let scans = messages(&with, "/scan");
    // A move takes some 24 physics steps, and each has beams.
    for (steps, scans) in steps.iter().zip(&scans) {
        assert!(
            *scans > 12 * steps && *scans < 60 * steps,
            "{scans} in {steps}"
        );
    }
    assert_eq!(
        messages(&without, "/scan"),
        [0, 0],
        "control: not asked for"
    );
    let file = with.join("ep-0002.mcap");
    expect(0, &["recording", "check", file.to_str().unwrap()]);
    expect(0, &["recording", "verify", with.to_str().unwrap()]);
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_seed_others() {
    let folder = tempfile::tempdir().unwrap();
    let run = |name: &str, seed: &str| {
        let path = folder.path().join(name);
        train(&path, "maze5", &["--episodes", "6", "--seed", seed]);
        contents(&path)
    };
    let (first, second, other) = (run("a", "7"), run("b", "7"), run("c", "8"));
    assert_eq!(
        first.len(),
        6 + 2 + 1 + 3 + 2,
        "six episodes, the run, the highlights and their page, three texts, two layouts"
    );
    for ((name, a), (_, b)) in first.iter().zip(&second) {
        assert!(a == b, "{name} differs between two runs of one seed");
    }
    let differing = first
        .iter()
        .zip(&other)
        .filter(|((_, a), (_, b))| a != b)
        .count();
    assert!(
        differing >= 9,
        "only {differing} files differ between two seeds"
    );
}

/// Worlds with a border and four moves, which a robot can drive in, and others.
const WORLDS: [(&str, bool); 5] = [
    ("maze4", true),
    ("maze5", true),
    ("maze6", true),
    ("woods1", false),
    ("maze4-classic", false),
];

#[test]
fn every_combination_that_makes_sense_runs_and_the_others_say_why_not() {
    // Few steps show that it runs.
    let mut settings = Settings::default();
    settings.reward.step_threshold = 5;
    settings.reward.step_threshold_from_maze = false;
    for (world, is_drivable) in WORLDS {
        for &method in Method::ALL {
            let arenas = ArenaKind::ALL.iter();
            for (&arena, &sensor) in arenas.flat_map(|a| Sensor::ALL.iter().map(move |s| (a, s))) {
                let plan = Plan::new(maze(world)).method(method).episodes(2);
                let plan = plan.settings(settings.clone());
                let result = plan.arena(arena).sensor(sensor).run();
                let what = format!("{world}, {method:?}, {arena:?}, {sensor:?}");
                // Where a combination makes no sense, the words that lead out of it.
                let ways_out = [(!is_drivable && arena == ArenaKind::Physics, "--arena grid")];
                let makes_sense = !ways_out.iter().any(|(applies, _)| *applies);
                match result {
                    Ok(trial) => {
                        assert!(makes_sense, "{what} ran");
                        assert_eq!(trial.progress().episodes, 2, "{what}");
                    }
                    Err(error) => {
                        let said = error.to_string();
                        let is_led = |(applies, way): &(bool, &str)| *applies && said.contains(way);
                        assert!(ways_out.iter().any(is_led), "{what}: {said}");
                    }
                }
            }
        }
    }
}

/// Two episodes of a method in a folder, by the program; gives its stderr.
fn two_episodes(code: i32, world: &str, method: Method, arena: &str, out: &Path) -> String {
    let (world, out) = (format!("worlds/{world}.json"), out.to_str().unwrap());
    let choices = ["--method", method.name(), "--arena", arena];
    let rest = ["--episodes", "2", "--record", "none", "--out", out];
    expect(code, &[&["train", &world], &choices[..], &rest].concat()).1
}

#[test]
fn the_program_takes_every_method_by_its_name() {
    let folder = tempfile::tempdir().unwrap();
    for (number, &method) in Method::ALL.iter().enumerate() {
        let out = folder.path().join(method.name());
        let arena = ["grid", "physics"][number % 2];
        two_episodes(0, "maze4", method, arena, &out);
        assert!(out.exists(), "{method:?} left no folder");
    }
}

#[test]
fn a_world_that_cannot_be_driven_in_is_refused_before_a_folder_is_made() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    for (world, is_drivable) in WORLDS {
        if !is_drivable {
            let stderr = two_episodes(65, world, Method::Xcscr, "physics", &out);
            assert!(stderr.contains("--arena grid"), "{world}: {stderr}");
            assert!(!out.exists(), "{world} left a folder");
        }
    }
}

#[test]
fn a_run_folder_that_exists_is_refused_until_it_is_forced() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    train(&run, "maze4", &["--episodes", "2"]);
    let before = contents(&run);
    let again = [
        "train",
        "worlds/maze4.json",
        "--episodes",
        "2",
        "--seed",
        "2",
        "--out",
        run.to_str().unwrap(),
    ];
    let (_, stderr) = expect(73, &again);
    assert!(stderr.contains("--force"), "{stderr}");
    assert!(
        contents(&run) == before,
        "the refused run changed the folder"
    );
    expect(0, &[&again[..], &["--force"]].concat());
    assert!(contents(&run) != before, "the forced run changed nothing");
}

#[test]
fn a_folder_that_holds_no_run_is_never_replaced() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("thesis.txt"), "years of work").unwrap();
    let out = folder.path().to_str().unwrap();
    expect(
        73,
        &[
            "train",
            "worlds/maze4.json",
            "--episodes",
            "1",
            "--force",
            "--out",
            out,
        ],
    );
    assert_eq!(
        fs::read(folder.path().join("thesis.txt")).unwrap(),
        b"years of work"
    );
}

#[test]
fn evaluate_follows_the_greedy_policy_in_noisy_physics() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    train(&run, "maze4", &["--arena", "grid", "--record", "none"]);
    let run = run.to_str().unwrap();
    let evaluation = json(&[
        "evaluate",
        run,
        "--arena",
        "physics",
        "--episodes",
        "20",
        "--require-optimal",
        "--json",
    ]);
    assert_eq!(evaluation["successes"], 20, "{evaluation}");
    assert_eq!(evaluation["optimal"], 20, "{evaluation}");
    assert_eq!(evaluation["mean_steps"], 10.0, "{evaluation}");
    assert_eq!(evaluation["collisions"], 0, "{evaluation}");
    let seconds = evaluation["mean_seconds"].as_f64().unwrap();
    assert!((5.0..30.0).contains(&seconds), "{evaluation}");
    // Control: in another maze the same rules are not optimal, and the code says so.
    let (_, stderr) = expect(
        1,
        &[
            "evaluate",
            run,
            "--world",
            "worlds/maze6.json",
            "--episodes",
            "5",
            "--require-optimal",
        ],
    );
    assert!(
        stderr.contains("of 5 episodes took a shortest path"),
        "{stderr}"
    );
    // Where moves slip, a path says nothing of who chose it.
    let slippery = "--world worlds/maze6.json --episodes 5 --set arena.slip=0.2 --require-optimal";
    let slippery: Vec<&str> = slippery.split(' ').collect();
    let (stdout, stderr) = expect(1, &[&["evaluate", run][..], &slippery].concat());
    assert!(
        stderr.contains("of 5 episodes chose only best actions"),
        "{stderr}"
    );
    assert!(
        stdout.contains("only best actions") && !stdout.contains("shortest"),
        "{stdout}"
    );
}

#[test]
fn evaluate_takes_a_lone_file_of_rules_with_a_world() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    train(&run, "maze4", &["--arena", "grid", "--record", "none"]);
    let lone = folder.path().join("my rules.json");
    fs::copy(run.join("rules.json"), &lone).unwrap();
    let lone = lone.to_str().unwrap();
    let world = [
        "--world",
        "worlds/maze4.json",
        "--arena",
        "grid",
        "--require-optimal",
    ];
    expect(
        0,
        &[&["evaluate", lone, "--episodes", "3"], &world[..]].concat(),
    );
    let (_, stderr) = expect(2, &["evaluate", lone]);
    assert!(stderr.contains("--world"), "{stderr}");
}

#[test]
fn a_recorded_evaluation_of_a_lone_file_names_the_method_that_it_is_of() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let world = [
        "--world",
        "worlds/maze4.json",
        "--arena",
        "grid",
        "--record",
    ];
    for (method, named) in [
        ("xcscr-plus", "xcscr-plus"),
        ("xcs", "xcscr"), // Its rules are like those of `xcscr`.
    ] {
        let (run, out) = (path(method), path(&format!("{method}-drives")));
        let more = ["--arena", "grid", "--record", "none", "--method", method];
        train(Path::new(&run), "maze4", &more);
        let lone = format!("{run}/rules.json");
        let evaluate = ["evaluate", &lone, "--episodes", "1", "--out", &out];
        expect(0, &[&evaluate[..], &world].concat());
        let (summary, _) = expect(0, &["recording", "info", &out]);
        assert!(
            summary.starts_with(&format!("maze4: {named} on ")),
            "{summary}"
        );
        let (verified, _) = expect(0, &["recording", "verify", &out]);
        assert!(verified.starts_with("2 of 2 "), "{verified}");
    }
}

#[test]
fn replay_verify_accepts_a_run_and_notices_one_changed_byte() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    train(&run, "maze4", &["--episodes", "5", "--seed", "3"]);
    let dir = run.to_str().unwrap();
    let (stdout, _) = expect(0, &["recording", "verify", dir]);
    assert_eq!(stdout, "7 of 7 recordings are bit-identical to a new run\n");
    let file = run.join("ep-0004.mcap");
    let sound = fs::read(&file).unwrap();
    for at in [10, sound.len() / 3, sound.len() / 2, sound.len() - 20] {
        let mut bytes = sound.clone();
        bytes[at] ^= 1;
        fs::write(&file, bytes).unwrap();
        let (stdout, _) = expect(1, &["recording", "verify", dir]);
        assert!(stdout.contains("ep-0004.mcap: "), "byte {at}: {stdout}");
        expect(1, &["recording", "verify", file.to_str().unwrap()]);
    }
    fs::write(&file, sound).unwrap();
    expect(0, &["recording", "verify", file.to_str().unwrap()]);
}

#[test]
fn check_accepts_recordings_and_refuses_damaged_ones() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    train(&run, "maze6", &["--episodes", "2"]);
    let file = run.join("ep-0002.mcap");
    let name = file.to_str().unwrap();
    assert_eq!(
        expect(0, &["recording", "check", name]).0,
        format!("{name}: sound\n")
    );
    let bytes = fs::read(&file).unwrap();
    fs::write(&file, &bytes[..bytes.len() / 2]).unwrap();
    expect(65, &["recording", "check", name]);
    expect(66, &["recording", "check", "no-such.mcap"]);
}

#[test]
fn settings_are_checked_before_any_work_and_the_message_gives_the_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let with = |set: &str| {
        let args = [
            "train",
            "worlds/maze4.json",
            "--out",
            out.to_str().unwrap(),
            "--set",
            set,
        ];
        let (_, stderr) = expect(65, &args);
        assert!(!out.exists(), "{set} left a folder");
        stderr
    };
    assert!(with("xcs.betta=0.1").contains("did you mean `xcs.beta`?"));
    assert!(with("xcs.beta=2").contains("must be from"));
    assert!(with("physics.noise=nan").contains("must be from"));
    assert!(with("reward.sharing=odd").contains("`even` or `discounted`"));
}

#[test]
fn episodes_outside_their_range_are_refused() {
    let (_, stderr) = expect(65, &["train", "worlds/maze4.json", "--episodes", "0"]);
    assert!(
        stderr.contains("`episodes` is 0, but must be from 1 to 1000000"),
        "{stderr}"
    );
}

#[test]
fn the_report_draws_the_policy_and_says_how_to_watch_it() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    let out = run.to_str().unwrap();
    let (stdout, stderr) = expect(
        0,
        &[
            "train",
            "worlds/maze4.json",
            "--arena",
            "grid",
            "--out",
            out,
        ],
    );
    assert_eq!(stderr, "", "no progress where nobody watches");
    for part in [
        "10 steps, 3 such paths",
        "globally optimal",
        "██→ ↓ ██",
        "/replay.html\n",
        "xcscr replay ",
    ] {
        assert!(stdout.contains(part), "{part} in\n{stdout}");
    }
}

#[test]
fn seeds_1_to_20_find_a_globally_optimal_policy_in_at_least_12_runs_in_both_arenas() {
    for &arena in ArenaKind::ALL {
        let found = (1..=20).filter(|&seed| {
            let plan = Plan::new(maze("maze4")).arena(arena).seed(seed);
            let mut trial = Trial::new(plan.episodes(180)).unwrap();
            // What comes after the first optimum changes nothing about it.
            while !trial.is_finished() && trial.progress().first_optimal_episode.is_none() {
                let _ = trial.run_episode(&mut ());
            }
            trial.progress().first_optimal_episode.is_some()
        });
        let found = found.count();
        assert!(found >= 12, "{found} of 20 on {arena:?}");
    }
}

#[test]
fn a_policy_that_takes_a_reward_on_its_way_is_told_to_arrive_and_one_that_does_not_arrive_is_not() {
    let folder = tempfile::tempdir().unwrap();
    let rows = [
        "##########",
        "#S.......#",
        "#.##.###.#",
        "#.#*...#.#",
        "#.####.#.#",
        "#........#",
        "#.######G#",
        "##########",
    ];
    let told = |reward: &str, [option, value]: [&str; 2], episodes: &str| {
        let name = format!("detour-{reward}-{episodes}");
        let world = folder.path().join(format!("{name}.json"));
        fs::write(
            &world,
            format!(r#"{{"rows": {rows:?}, "reward": {reward}}}"#),
        )
        .unwrap();
        let out = folder.path().join(name);
        let [world, out] = [&world, &out].map(|path| path.to_str().unwrap());
        let what = "train --arena grid --sensor neighbours-position --record none";
        let chosen = [option, value, "--episodes", episodes, "--out", out];
        let what = what.split_whitespace().chain(chosen).chain([world]);
        expect(0, &what.collect::<Vec<_>>()).0
    };
    let map = ["--set", "plus.estimator=map"];
    let rich = told("500", map, "60");
    assert!(
        rich.contains("greedy policy now    14 steps, not globally optimal\n")
            && rich.contains("it takes             14 steps to the goal, by way of a reward\n")
            && !rich.contains("try  "),
        "{rich}"
    );
    let poor = told("0.001", map, "60");
    assert!(poor.contains("12 steps, globally optimal\n"), "{poor}");
    assert!(!poor.contains("by way of"), "control: {poor}");
    let young = told("500", ["--method", "xcs"], "1");
    assert!(
        !young.contains("to the goal") && young.contains("try  "),
        "control: {young}"
    );
}

#[test]
fn recordings_and_trial_agree_when_a_policy_with_a_memory_is_optimal() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    let more = "--arena grid --sensor neighbours --episodes 12";
    let more: Vec<&str> = more.split_whitespace().collect();
    let report = train(&run, "classic/mazef4", &more);
    let first = report["first_optimal_episode"].as_u64().unwrap();
    assert!(1 < first && first < 12, "{report}");
    let replayed = expect(0, &["recording", "info", run.to_str().unwrap()]).0;
    let told = format!(", first in episode {first}\n");
    let line = replayed
        .lines()
        .find(|line| line.contains("policy optimal"));
    let line = format!("{}\n", line.unwrap_or(&replayed));
    assert!(line.ends_with(&told), "{line}, {report}");
}

#[test]
fn where_cells_share_a_percept_the_learner_changes_to_a_map_by_itself() {
    let folder = tempfile::tempdir().unwrap();
    let trained = |name: &str, world: &str, more: &[&str]| {
        let out = folder.path().join(name);
        let what = "train --arena grid --record none --quiet --json --episodes 20 --out";
        let what = what
            .split_whitespace()
            .chain([out.to_str().unwrap(), world]);
        let (report, said) = expect(0, &what.chain(more.iter().copied()).collect::<Vec<_>>());
        assert_eq!(said, "", "no warning is due");
        let report: Value = serde_json::from_str(&report).unwrap();
        (report["estimator"].clone(), report["retained"].clone())
    };
    let aliased = "worlds/classic/mazef4.json";
    assert_eq!(trained("usual", aliased, &[]), ("map".into(), true.into()));
    let noisy = ["--set", "sensor.flip_probability=0.02"];
    let maze5 = "worlds/maze5.json";
    assert_eq!(trained("noisy", maze5, &noisy).0, "map");
    // Controls: percepts that are right tell all cells of Maze5 apart, and a position does so anywhere.
    assert_eq!(
        trained("clear", maze5, &[]),
        ("percept".into(), true.into())
    );
    let told = ["--sensor", "neighbours-position"];
    assert_eq!(
        trained("told", aliased, &told),
        ("percept".into(), true.into())
    );
}

#[test]
fn in_mazes_of_more_than_1024_cells_the_usual_percept_has_the_position() {
    let folder = tempfile::tempdir().unwrap();
    for (size, sensor) in [("32", "neighbours"), ("33", "neighbours-position")] {
        let args = ["world", "generate", "--kind", "dfs", "--size", size];
        let world = folder.path().join(format!("{size}.json"));
        fs::write(&world, expect(0, &args).0).unwrap();
        let [world, out] = [world, folder.path().join(size)];
        let [world, out] = [&world, &out].map(|path| path.to_str().unwrap());
        let what = "train --arena grid --record none --quiet --json --episodes 1 --out";
        let what = what.split_whitespace().chain([out, world]);
        let (report, _) = expect(0, &what.collect::<Vec<_>>());
        let report: Value = serde_json::from_str(&report).unwrap();
        assert_eq!(report["sensor"], sensor, "{size}");
    }
}
