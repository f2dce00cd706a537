//! Recordings of agents that are not part of the program.

use std::path::Path;

use crate::kit::desk::Desk;
use crate::kit::trial::maze;
use xcscr::arena::ArenaKind;
use xcscr::record::{RecordMode, RunKind};
use xcscr::run::{ExternalEpisode, ExternalRecorder};
use xcscr::trial::Plan;

/// The recordings that [`recorded`] makes.
const FILES: &str = "@run/ep-0001.mcap @run/ep-0002.mcap @run/run.mcap";

fn plan(arena: ArenaKind) -> Plan {
    let mut plan = Plan::new(maze("maze4")).arena(arena).episodes(1);
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

fn recorder(folder: &Path, plan: &Plan) -> ExternalRecorder {
    ExternalRecorder::create(folder, plan, RecordMode::All).unwrap()
}

/// Records two episodes of a scripted agent into a folder of a desk.
fn record(desk: &Desk, folder: &str, arena: ArenaKind, first: &[usize]) {
    let mut recorder = recorder(&desk.path(folder), &plan(arena));
    recorder.record(episode(7, first)).unwrap();
    recorder.record(episode(8, &[2, 2, 1])).unwrap();
    assert_eq!(recorder.finish().unwrap().files.len(), 3);
}

fn recorded(arena: ArenaKind) -> Desk {
    let desk = Desk::new();
    record(&desk, "run", arena, &[1, 2, 2, 1, 0, 3]);
    desk
}

#[test]
fn check_and_verify_accept_a_recording_of_an_external_agent_in_both_arenas() {
    for &arena in ArenaKind::ALL {
        let desk = recorded(arena);
        desk.ok(&format!("recording check {FILES}"));
        let said = desk.ok(&format!("recording verify {FILES}"));
        let words = "3 of 3 recordings are bit-identical";
        assert!(said.contains(words), "{said}");
        let episode = desk.recording("run/ep-0002.mcap");
        assert_eq!(episode.run_kind(), RunKind::External);
        assert!(!episode.metadata("run").unwrap().contains_key("episodes"));
    }
}

#[test]
fn an_episode_does_not_depend_on_the_episodes_before_it() {
    let end = |first: Option<ExternalEpisode>, rate: f64| {
        let mut plan = plan(ArenaKind::Physics);
        plan.config.settings.physics.lidar.rate_hz = rate;
        let desk = Desk::new();
        let mut recorder = recorder(desk.folder(), &plan);
        if let Some(episode) = first {
            recorder.record(episode).unwrap();
        }
        let end = recorder.record(episode(8, &[2, 2, 1, 1, 1, 0])).unwrap();
        end.robot_in_map
    };
    for rate in [5.0, 5.5, 7.3] {
        let before = episode(7, &[1, 1, 2, 1, 0]);
        assert_eq!(end(None, rate), end(Some(before), rate), "{rate} Hz");
    }
}

#[test]
fn verify_refutes_a_recording_with_the_actions_of_another_one() {
    let desk = recorded(ArenaKind::Grid);
    record(&desk, "other", ArenaKind::Grid, &[1, 1, 2, 1, 0, 3]);
    std::fs::rename(desk.path("other/run.mcap"), desk.path("run/run.mcap")).unwrap();
    let (said, _) = desk.run(1, &format!("recording verify {FILES}"));
    assert!(said.contains("ep-0001.mcap"), "{said}");
}

#[test]
fn a_recording_without_a_policy_gives_no_rules_and_no_highlights() {
    let desk = recorded(ArenaKind::Grid);
    for (line, words) in [
        ("rules list @run/run.mcap", ""),
        ("recording ros @run/run.mcap", ""),
        (
            "recording highlights @run/run.mcap -o @highlights.mcap",
            "external agent",
        ),
    ] {
        let code = desk.output(line).status.code().unwrap();
        assert_ne!(code, 0, "{line}");
        desk.fails(code, line, words);
    }
}

#[test]
fn impossible_episodes_and_folders_with_files_are_refused() {
    let desk = Desk::new();
    let plan = plan(ArenaKind::Grid);
    let mut recorder = recorder(desk.folder(), &plan);
    let in_a_wall = ExternalEpisode {
        start: (0, 0),
        ..episode(1, &[1])
    };
    let rewarded = |rewards| ExternalEpisode {
        rewards,
        ..episode(1, &[1])
    };
    for episode in [
        in_a_wall,
        rewarded(vec![f64::NAN]),
        rewarded(Vec::new()),
        episode(1, &[4]),
        episode(1, &[]),
    ] {
        let fault = recorder.record(episode).unwrap_err().to_string();
        assert!(fault.contains("episode 1: "), "{fault}");
    }
    drop(recorder);
    let again = ExternalRecorder::create(desk.folder(), &plan, RecordMode::All);
    let fault = again.err().unwrap().to_string();
    assert!(fault.contains("the folder contains files"), "{fault}");
}
