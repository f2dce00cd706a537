//! Recordings of agents that are not part of the program.

use std::path::Path;

use crate::kit::program::expect;
use tempfile::TempDir;
use xcscr::arena::ArenaKind;
use xcscr::record::RecordMode;
use xcscr::record::reader::Recording;
use xcscr::run::{ExternalEpisode, ExternalRecorder};
use xcscr::trial::Plan;
use xcscr::world::Maze;

fn plan(arena: ArenaKind) -> Plan {
    let maze = Maze::load(Path::new("worlds/maze4.json")).unwrap();
    let mut plan = Plan::new(maze).arena(arena).episodes(1);
    plan.config.settings.arena.slip = 0.2;
    plan
}

fn episode(seed: u64, actions: &[usize]) -> ExternalEpisode {
    ExternalEpisode {
        seed,
        start: (1, 1),
        actions: actions.to_vec(),
        rewards: actions.iter().map(|&action| action as f64 - 0.1).collect(),
    }
}

/// Records two episodes of a scripted agent.
fn recorded(arena: ArenaKind, mode: RecordMode) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let mut recorder = ExternalRecorder::create(folder.path(), &plan(arena), mode).unwrap();
    recorder.record(episode(7, &[1, 2, 2, 1, 0, 3])).unwrap();
    recorder.record(episode(8, &[2, 2, 1])).unwrap();
    let files = recorder.finish().unwrap().files;
    assert_eq!(files.len(), 3);
    folder
}

fn files(folder: &Path) -> Vec<String> {
    let names = ["ep-0001.mcap", "ep-0002.mcap", "run.mcap"];
    let path = |name| folder.join(name).to_str().unwrap().to_owned();
    names.map(path).to_vec()
}

fn run(code: i32, command: &str, files: &[String]) -> (String, String) {
    let files = files.iter().map(String::as_str);
    let args: Vec<&str> = ["recording", command].into_iter().chain(files).collect();
    expect(code, &args)
}

#[test]
fn check_and_verify_accept_a_recording_of_an_external_agent_in_both_arenas() {
    for arena in [ArenaKind::Grid, ArenaKind::Physics] {
        let folder = recorded(arena, RecordMode::All);
        let files = files(folder.path());
        run(0, "check", &files);
        let (said, _) = run(0, "verify", &files);
        assert!(
            said.contains("3 of 3 recordings are bit-identical"),
            "{said}"
        );
        let episode = Recording::open(Path::new(&files[1])).unwrap();
        assert!(episode.is_external() && !episode.is_evaluation());
        assert!(!episode.metadata("run").unwrap().contains_key("episodes"));
    }
}

#[test]
fn an_episode_does_not_depend_on_the_episodes_before_it() {
    let wanted = |first: Option<ExternalEpisode>, rate: f64| {
        let mut plan = plan(ArenaKind::Physics);
        plan.config.settings.physics.lidar.rate_hz = rate;
        let folder = tempfile::tempdir().unwrap();
        let mode = RecordMode::All;
        let mut recorder = ExternalRecorder::create(folder.path(), &plan, mode).unwrap();
        if let Some(episode) = first {
            recorder.record(episode).unwrap();
        }
        let end = recorder.record(episode(8, &[2, 2, 1, 1, 1, 0])).unwrap();
        end.robot_in_map
    };
    for rate in [5.0, 5.5, 7.3] {
        let before = episode(7, &[1, 1, 2, 1, 0]);
        assert_eq!(wanted(None, rate), wanted(Some(before), rate), "{rate} Hz");
    }
}

#[test]
fn verify_refutes_a_recording_with_the_actions_of_another_one() {
    let folder = recorded(ArenaKind::Grid, RecordMode::All);
    let other = tempfile::tempdir().unwrap();
    let plan = plan(ArenaKind::Grid);
    let mut recorder = ExternalRecorder::create(other.path(), &plan, RecordMode::All).unwrap();
    recorder.record(episode(7, &[1, 1, 2, 1, 0, 3])).unwrap();
    recorder.record(episode(8, &[2, 2, 1])).unwrap();
    recorder.finish().unwrap();
    std::fs::copy(
        other.path().join("run.mcap"),
        folder.path().join("run.mcap"),
    )
    .unwrap();
    let (said, _) = run(1, "verify", &files(folder.path()));
    assert!(said.contains("ep-0001.mcap"), "{said}");
}

#[test]
fn a_recording_without_a_policy_gives_no_rules_and_no_highlights() {
    let folder = recorded(ArenaKind::Grid, RecordMode::All);
    let run = folder.path().join("run.mcap");
    let run = run.to_str().unwrap();
    for args in [["rules", "list", run], ["recording", "ros", run]] {
        let output = crate::kit::program::outcome(&args);
        assert_ne!(output.0, Some(0), "{args:?}");
        assert!(!output.2.contains("panicked"), "{}", output.2);
    }
    let out = folder.path().join("highlights.mcap");
    let args = ["recording", "highlights", run, "-o", out.to_str().unwrap()];
    let (_, _, said) = crate::kit::program::outcome(&args);
    assert!(said.contains("external agent"), "{said}");
}

#[test]
fn impossible_episodes_and_folders_with_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let plan = plan(ArenaKind::Grid);
    let mut recorder = ExternalRecorder::create(folder.path(), &plan, RecordMode::All).unwrap();
    let refused = [
        ExternalEpisode {
            start: (0, 0),
            ..episode(1, &[1])
        },
        ExternalEpisode {
            rewards: vec![f64::NAN],
            ..episode(1, &[1])
        },
        ExternalEpisode {
            rewards: Vec::new(),
            ..episode(1, &[1])
        },
        episode(1, &[4]),
        episode(1, &[]),
    ];
    for episode in refused {
        let fault = recorder.record(episode).unwrap_err().to_string();
        assert!(fault.contains("episode 1: "), "{fault}");
    }
    drop(recorder);
    let again = ExternalRecorder::create(folder.path(), &plan, RecordMode::All);
    assert!(
        again
            .err()
            .unwrap()
            .to_string()
            .contains("the folder contains files")
    );
}
