//! A run that was stopped goes on to the same bytes as one that never was.
//!
//! `XCSCR_LONG=1 cargo test --test runs resume` stops ten times as often in runs that are
//! twice as long, and kills 200 times.

use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::kit::chance::{dice, rounds};
use crate::kit::folder::{assert_same, contents};
use crate::kit::program::{ended, expect, signal, spawn};
use crate::kit::trial::on_the_grid;
use xcscr::agent::{Estimator, Method, MotionPrior};
use xcscr::arena::ArenaKind;
use xcscr::episode::{Episode, Learned, Observer};
use xcscr::record::{self, RecordMode, Recorder, RecorderMemory, RobotShape, RunInfo, RunKind};
use xcscr::run::{Resumed, RunError, RunFolder, Session};
use xcscr::sensor::Sensor;
use xcscr::trial::{Checkpoint, Plan, Settings, Trial, seal, unseal};
use xcscr::xcs::random::Stream;

fn plan(world: &str, method: Method, arena: ArenaKind, episodes: u32) -> Plan {
    let plan = on_the_grid(world, method).arena(arena);
    plan.episodes(episodes).seed(3)
}

fn info(plan: &Plan) -> RunInfo {
    RunInfo {
        world_json: plan.maze.to_json(),
        config_json: serde_json::to_string(&plan.config).unwrap(),
        seed: plan.config.seed,
        method: plan.config.method.name().to_owned(),
        arena: plan.config.arena.name().to_owned(),
        sensor: plan.config.sensor,
        episodes: plan.config.episodes,
        robot: RobotShape::for_cell(plan.maze.cell_size_m()),
        slip: 0.0,
        goal: 1000.0,
        kind: RunKind::Training,
    }
}

/// A trial with its recorder.
struct Run(Trial, Recorder);

impl Run {
    fn begin(plan: &Plan, folder: &Path, mode: RecordMode) -> Self {
        let recorder = Recorder::create(folder, &plan.maze, info(plan), mode).unwrap();
        Self(Trial::new(plan.clone()).unwrap(), recorder)
    }

    fn resume(bytes: &[u8], folder: &Path) -> Self {
        let (trial, recorder): (Checkpoint, RecorderMemory) = unseal(bytes).unwrap();
        let trial = Trial::resume(&trial).unwrap();
        let (maze, info, policy) = (&trial.plan().maze, info(trial.plan()), trial.policy());
        let recorder = Recorder::resume(folder, maze, info, recorder, policy).unwrap();
        Self(trial, recorder)
    }

    fn save(&mut self) -> Vec<u8> {
        seal(&(self.0.checkpoint(), self.1.memory().unwrap()))
    }

    fn episodes(&mut self, up_to: u32) {
        while self.0.progress().episodes < up_to {
            let _ = self.0.run_episode(&mut self.1);
        }
    }

    /// Ends the run; gives the state of everything that decides about what would come next.
    fn end(self) -> Vec<u8> {
        let Self(trial, recorder) = self;
        let end = seal(&(trial.checkpoint(), trial.method().knowledge()));
        recorder.finish(trial.method()).unwrap();
        end
    }
}

/// Stops a run so often: makes a checkpoint, goes on for a while, is killed, resumes there.
fn run_with_stops(plan: &Plan, folder: &Path, mode: RecordMode, times: usize) -> (String, Vec<u8>) {
    let all = plan.config.episodes as usize;
    let mut dice = dice(plan.config.method as u64 * 2 + plan.config.arena as u64);
    let mut stops: Vec<usize> = (0..times).map(|_| dice.below(all + 1)).collect();
    stops.sort();
    let mut run = Run::begin(plan, folder, mode);
    let mut history = String::new();
    for stop in stops {
        run.episodes(stop as u32);
        let bytes = run.save();
        let killed = stop + dice.below(all - stop + 1).min(4);
        run.episodes(killed as u32);
        history += &format!("checkpoint after episode {stop}, killed after {killed}; ");
        // As a kill would leave it: the unfinished file is dropped where it is.
        drop(run);
        run = Run::resume(&bytes, folder);
    }
    run.episodes(all as u32);
    (history, run.end())
}

fn stops_and_resumes(method: Method, arena: ArenaKind, mode: RecordMode, times: usize) {
    let episodes = rounds(12, 24) as u32;
    let plan = plan("maze4", method, arena, episodes);
    let folder = tempfile::tempdir().unwrap();
    let wanted = folder.path().join("wanted");
    let mut whole = Run::begin(&plan, &wanted, mode);
    whole.episodes(episodes);
    let end = whole.end();
    let found = folder.path().join("found");
    let (history, stopped) = run_with_stops(&plan, &found, mode, times);
    let (method, arena) = (method.name(), arena.name());
    let what = format!("{method} on {arena}, {mode}: {history}");
    assert!(
        stopped == end,
        "{what}the learner or a random stream differs"
    );
    if mode != RecordMode::None {
        assert_same(&found, &wanted, &what);
    }
}

#[test]
fn every_method_in_both_arenas_resumes_to_the_same_bytes() {
    for &method in Method::ALL {
        for &arena in ArenaKind::ALL {
            stops_and_resumes(method, arena, RecordMode::All, rounds(4, 40));
        }
    }
}

/// Then a learner may have perceived what it could learn nothing of yet.
#[test]
fn every_method_resumes_after_episodes_of_one_step() {
    for &method in Method::ALL {
        let mut plan = plan("maze4", method, ArenaKind::Grid, 6);
        plan.config.settings.reward.step_threshold_from_maze = false;
        plan.config.settings.reward.step_threshold = 1;
        plan.config.settings.reward.learning_step_threshold = false;
        let end = |stop: u32| {
            let mut trial = Trial::new(plan.clone()).unwrap();
            while trial.progress().episodes < 6 {
                if trial.progress().episodes == stop {
                    let resumed = Trial::resume(&trial.checkpoint());
                    trial = resumed.unwrap_or_else(|e| panic!("{}: {e}", method.name()));
                }
                let _ = trial.run_episode(&mut ());
            }
            seal(&trial.checkpoint())
        };
        let whole = end(6);
        assert!(end(1) == whole && end(2) == whole, "{}", method.name());
    }
}

/// Between successes it learns which way its actions go, but plans with what it knew at the last one.
#[test]
fn a_memory_that_learns_its_moves_resumes_after_any_episode_on_any_percept() {
    let sensors = [(8, Sensor::Neighbours), (9, Sensor::Lidar)];
    let of = |method| sensors.map(|(seed, sensor)| (method, seed, sensor));
    for (method, seed, sensor) in [Method::XcscrPlus, Method::RMax].map(of).concat() {
        let mut plan = plan("classic/maze10", method, ArenaKind::Grid, 8);
        plan = plan.seed(seed).sensor(sensor);
        let settings = &mut plan.config.settings;
        settings.plus.estimator = Estimator::Map;
        settings.map.motion_model = MotionPrior::Learned;
        (settings.arena.slip, settings.sensor.flip_probability) = (0.4, 0.02);
        settings.reward.step_threshold_from_maze = false;
        settings.reward.step_threshold = 9;
        let mut whole = Trial::new(plan).unwrap();
        while whole.progress().episodes < 8 {
            let resumed = Trial::resume(&whole.checkpoint());
            let mut resumed = resumed.unwrap_or_else(|e| panic!("{}: {e}", sensor.name()));
            let _ = (whole.run_episode(&mut ()), resumed.run_episode(&mut ()));
            let episode = whole.progress().episodes;
            assert!(
                seal(&whole.checkpoint()) == seal(&resumed.checkpoint()),
                "{}, episode {episode}",
                sensor.name()
            );
        }
    }
}

#[test]
fn a_memory_holds_what_was_learned_and_no_settings() {
    let settings = |beta, gamma, theta_x, alpha| {
        let mut settings = Settings::default();
        settings.xcs.beta = beta;
        (settings.reward.gamma, settings.reward.theta_x) = (gamma, theta_x);
        settings.tabular.alpha = alpha;
        settings
    };
    for &method in Method::ALL {
        let memory = |settings: &Settings, episodes| {
            let mut plan = plan("maze4", method, ArenaKind::Grid, 6);
            plan.config.settings = settings.clone();
            let mut trial = Trial::new(plan).unwrap();
            for _ in 0..episodes {
                let _ = trial.run_episode(&mut ());
            }
            trial.method().checkpoint()
        };
        let [one, other] = [settings(0.1, 0.5, 0.2, 0.3), settings(0.2, 0.6, 0.1, 0.4)];
        let name = method.name();
        assert!(
            memory(&one, 0) == memory(&other, 0),
            "{name} keeps settings"
        );
        assert!(
            memory(&one, 0) != memory(&one, 3),
            "control: {name} learned nothing"
        );
    }
}

#[test]
fn every_mode_of_recording_resumes_to_the_same_files() {
    for mode in ["best", "last", "every:3", "none"] {
        let mode = mode.parse().unwrap();
        stops_and_resumes(Method::Xcscr, ArenaKind::Grid, mode, rounds(8, 80));
    }
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

/// Trains, and is stopped by signals at random moments of what an undisturbed run takes, until it ends
/// by itself. Gives what it prints then.
fn train_with_kills(
    out: &Path,
    begin: &[&str],
    undisturbed: Duration,
    dice: &mut Stream,
) -> (String, String) {
    let dir = out.to_str().unwrap();
    let mut history = String::new();
    let mut before = 0;
    for attempt in 0..5 {
        // A kill can come after the run is done, but before it has said so.
        let is_there = |name: &str| out.join(name).is_file();
        let args = match is_there("checkpoint") || is_there("rules.json") {
            true => vec!["train", "--resume", dir, "--json"],
            false => begin.to_vec(),
        };
        let mut child = spawn(&args);
        let pause = undisturbed.mul_f64(dice.unit());
        let name = *dice
            .choose(&["KILL", "KILL", "TERM", "INT", "USR1"])
            .unwrap();
        sleep(pause);
        if attempt < 4 {
            signal(&child, name);
        }
        history += &format!("{name} after {pause:?}; ");
        let status = child.wait().unwrap();
        let output = std::process::Output {
            status,
            ..child.wait_with_output().unwrap()
        };
        if status.success() {
            return (history, ended(&output, 0, "").0);
        }
        if status.code().is_some_and(|code| code == 75) {
            ended(&output, 75, &history);
        }
        if out.is_dir() {
            let now = assert_sound(out, &history);
            assert!(
                now >= before,
                "{history}: {before} episodes were finished, now {now}"
            );
            before = now;
        }
    }
    panic!("{history}: never ended");
}

#[test]
fn a_run_killed_at_random_moments_loses_no_finished_episode_and_ends_in_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let dir = out.to_str().unwrap();
    let args = [
        "train",
        "worlds/maze4.json",
        "--arena",
        "grid",
        "--seed",
        "5",
        "--out",
        dir,
        "--json",
    ];
    let begun = Instant::now();
    let (wanted_json, _) = expect(0, &args);
    let undisturbed = begun.elapsed();
    let wanted = folder.path().join("wanted");
    fs::rename(&out, &wanted).unwrap();
    let mut dice = dice(11);
    let (mut kills, mut round) = (0, 0);
    // A signal that comes too late proves nothing, and does not count.
    while kills < rounds(10, 200) {
        round += 1;
        let (history, json) = train_with_kills(&out, &args, undisturbed, &mut dice);
        let what = format!("round {round}: {history}");
        assert_same(&out, &wanted, &what);
        if !json.contains("\"finished\": true") {
            assert_eq!(json, wanted_json, "{what}");
        }
        fs::remove_dir_all(&out).unwrap();
        let stops = history.trim_end_matches("; ").rsplit_once("; ");
        kills += stops.map_or(0, |(stops, _)| stops.matches("KILL").count());
    }
}

#[test]
fn an_interrupted_run_is_named_and_a_finished_one_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let dir = out.to_str().unwrap();
    let begin = [
        "train",
        "worlds/maze4.json",
        "--episodes",
        "100",
        "--out",
        dir,
    ];
    let child = spawn(&begin);
    while !out.join("ep-0003.mcap").exists() {
        sleep(Duration::from_millis(5));
    }
    signal(&child, "TERM");
    let (_, stderr) = ended(&child.wait_with_output().unwrap(), 75, "TERM");
    let way_on = format!("`xcscr train --resume {dir}`");
    assert!(stderr.contains(&way_on), "{stderr}");
    let (_, stderr) = expect(65, &["recording", "info", dir]);
    assert!(stderr.contains(&way_on), "{stderr}");
    let before = contents(&out);
    let (_, stderr) = expect(73, &begin);
    assert!(
        stderr.contains("interrupted run") && stderr.contains(&way_on),
        "{stderr}"
    );
    assert!(contents(&out) == before, "a refusal changed the folder");
    expect(0, &["train", "--resume", dir, "--json"]);
    let before = contents(&out);
    let (stdout, _) = expect(0, &["train", "--resume", dir]);
    assert!(stdout.contains("is finished: all 100 episodes"), "{stdout}");
    let (stdout, _) = expect(0, &["train", "--resume", dir, "--json"]);
    assert!(stdout.contains("\"finished\": true"), "{stdout}");
    assert!(contents(&out) == before, "a finished run was changed");
}

/// The report at the end is about the run, and not about what was left of it.
#[test]
fn the_small_curve_of_a_resumed_run_shows_all_of_its_episodes() {
    let folder = tempfile::tempdir().unwrap();
    let [out, whole] = ["run", "whole"].map(|name| folder.path().join(name));
    let few = [
        "train",
        "worlds/maze4.json",
        "--episodes",
        "40",
        "--method",
        "q-learning",
        "--out",
    ];
    let [stopped, unstopped] =
        [&out, &whole].map(|out| [&few[..], &[out.to_str().unwrap()]].concat());
    let curve = |report: &str| {
        let mut lines = report.lines();
        let line = lines.find(|line| line.starts_with("  steps per episode"));
        line.unwrap().to_owned()
    };
    let child = spawn(&stopped);
    while !out.join("ep-0003.mcap").exists() {
        sleep(Duration::from_millis(5));
    }
    signal(&child, "TERM");
    ended(&child.wait_with_output().unwrap(), 75, "TERM");
    // Control: some of the episodes, and not all, were left to the second session.
    assert!(!out.join("ep-0040.mcap").exists());
    let (resumed, _) = expect(0, &["train", "--resume", out.to_str().unwrap()]);
    let (wanted, _) = expect(0, &unstopped);
    assert_eq!(curve(&resumed), curve(&wanted));
    assert_eq!(
        curve(&wanted).chars().count(),
        "  steps per episode    ".len() + 40
    );
}

#[test]
fn resuming_takes_no_other_choices_and_needs_a_run() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().to_str().unwrap();
    let (_, stderr) = expect(66, &["train", "--resume", dir]);
    assert!(stderr.contains("contains no interrupted run"), "{stderr}");
    expect(66, &["train", "--resume", "no/such/folder"]);
    expect(2, &["train", "--resume", dir, "--seed", "2"]);
    expect(2, &["train", "--resume", dir, "worlds/maze4.json"]);
    expect(2, &["train"]);
}

/// A folder of an interrupted run, and what resuming it says.
fn resuming_after(change: impl Fn(&Path)) -> (i32, String) {
    let folder = tempfile::tempdir().unwrap();
    let plan = plan("maze4", Method::Xcscr, ArenaKind::Grid, 5);
    let run = RunFolder::create(folder.path(), true).unwrap();
    let session = Session::begin(run, Trial::new(plan).unwrap(), RecordMode::All).unwrap();
    assert!(session.run(&mut (), &|| true).is_err());
    change(folder.path());
    let before = contents(folder.path());
    let dir = folder.path().to_str().unwrap();
    let ended = spawn(&["train", "--quiet", "--resume", dir])
        .wait_with_output()
        .unwrap();
    let code = ended.status.code().unwrap();
    assert!(
        code == 0 || contents(folder.path()) == before,
        "a refusal changed the folder"
    );
    (code, String::from_utf8(ended.stderr).unwrap())
}

#[test]
fn a_run_whose_settings_or_world_were_changed_by_hand_is_not_resumed() {
    let edit = |name: &'static str, from: &'static str, to: &'static str| {
        move |folder: &Path| {
            let path = folder.join(name);
            let text = fs::read_to_string(&path).unwrap();
            assert!(text.contains(from), "{text}");
            fs::write(path, text.replacen(from, to, 1)).unwrap();
        }
    };
    assert_eq!(resuming_after(|_| {}).0, 0, "the control");
    let removed = |folder: &Path| fs::remove_file(folder.join("config.json")).unwrap();
    assert_eq!(
        resuming_after(removed).0,
        0,
        "a file that is removed is written again"
    );
    let name = "config.json";
    let (code, stderr) = resuming_after(edit(name, "\"episodes\": 5", "\"episodes\": 9"));
    assert!(
        code == 65 && stderr.contains("config.json was changed"),
        "{code}: {stderr}"
    );
    let (code, stderr) = resuming_after(edit("world.json", "S", "."));
    assert!(
        code == 65 && stderr.contains("world.json was changed"),
        "{code}: {stderr}"
    );
}

#[test]
fn resuming_replaces_no_file_that_another_program_wrote() {
    for name in ["ep-0003.mcap", "highlights.mcap", "rules.json"] {
        let put = |folder: &Path| fs::write(folder.join(name), "mine").unwrap();
        let (code, stderr) = resuming_after(put);
        let said = format!("{name} is not a file of this run");
        assert!(code == 73 && stderr.contains(&said), "{code}: {stderr}");
    }
    let beside = |folder: &Path| fs::write(folder.join("notes.mcap"), "mine").unwrap();
    assert_eq!(resuming_after(beside).0, 0, "a name that no run uses");
    let lost = |folder: &Path| fs::remove_file(folder.join("run.mcap.part")).unwrap();
    let (code, stderr) = resuming_after(lost);
    assert!(
        code == 66 && stderr.contains("run.mcap.part"),
        "{code}: {stderr}"
    );
}

#[test]
fn a_damaged_or_foreign_checkpoint_is_refused_and_left_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().to_str().unwrap();
    let file = folder.path().join("checkpoint");
    let run = Run::begin(
        &plan("maze4", Method::Xcscr, ArenaKind::Grid, 5),
        &folder.path().join("unused"),
        RecordMode::None,
    );
    let sound = seal(&(run.0.checkpoint(), 0_u8));
    let mut flipped = sound.clone();
    flipped[sound.len() / 2] ^= 1;
    let mut newer = sound.clone();
    newer[8] += 1;
    let has_format = format!("it has format {}", newer[8]);
    for (bytes, words) in [
        (&flipped[..], "its checksum is wrong"),
        (&sound[..sound.len() / 2], "but should have"),
        (&newer[..], &has_format),
        (b"not at all", "it is not a checkpoint"),
        (&sound[..], "its content is inconsistent"),
    ] {
        fs::write(&file, bytes).unwrap();
        let (_, stderr) = expect(65, &["train", "--resume", dir]);
        assert!(
            stderr.contains(words) && stderr.contains("checkpoint"),
            "{stderr}"
        );
        assert!(
            fs::read(&file).unwrap() == bytes,
            "the checkpoint was changed"
        );
    }
}

/// Asks for the end after each episode.
struct Impatient;

impl Observer for Impatient {
    fn ended(&mut self, _: &Episode, _: &Learned<'_>) -> ControlFlow<()> {
        ControlFlow::Break(())
    }
}

#[test]
fn an_observer_ends_a_recorded_run_which_resumes_to_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let plan = plan("maze4", Method::Xcscr, ArenaKind::Grid, 3);
    let [whole, stopped] = ["whole", "stopped"].map(|name| folder.path().join(name));
    let begin = |path: &Path| {
        let run = RunFolder::create(path, false).unwrap();
        Session::begin(run, Trial::new(plan.clone()).unwrap(), RecordMode::All).unwrap()
    };
    begin(&whole).run(&mut (), &|| false).unwrap();
    let error = begin(&stopped).run(&mut Impatient, &|| false).err();
    assert!(
        matches!(
            error,
            Some(RunError::Interrupted {
                done: 1,
                all: 3,
                ..
            })
        ),
        "{error:?}"
    );
    let Resumed::Unfinished(session) =
        Session::resume(RunFolder::resume(&stopped).unwrap()).unwrap()
    else {
        panic!("the run has a checkpoint");
    };
    session.run(&mut (), &|| false).unwrap();
    assert_same(&stopped, &whole, "after an observer's break");
}
