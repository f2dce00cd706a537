//! Recordings of agents that are not part of the program.

use std::path::Path;

use crate::kit::desk::Desk;
use crate::kit::messages;
use crate::kit::trial::maze;
use xcscr::arena::ArenaKind;
use xcscr::record::{RecordMode, RunKind};
use xcscr::run::{ExternalActions, ExternalEpisode, ExternalRecorder, WheelSpeeds};
use xcscr::sensor::Sensor;
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
        actions: ExternalActions::Moves(actions.to_vec()),
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
        assert_eq!(episode.run_kind().unwrap(), RunKind::External);
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

/// An episode in which the robot drives an arc into a wall.
fn driven(seed: u64, last_mps: f64) -> ExternalEpisode {
    let mut speeds_mps = vec![[0.8, 0.3]; 60];
    speeds_mps[59][1] = last_mps;
    ExternalEpisode {
        seed,
        start: (1, 1),
        rewards: vec![-0.1; speeds_mps.len()],
        actions: ExternalActions::Wheels(WheelSpeeds {
            heading_rad: 0.3,
            speeds_mps,
        }),
    }
}

/// Records two episodes of wheel speeds into a folder of a desk.
fn record_wheels(desk: &Desk, folder: &str, last_mps: f64) {
    let plan = plan(ArenaKind::Physics).sensor(Sensor::Neighbours);
    let mut recorder = recorder(&desk.path(folder), &plan);
    recorder.record(driven(7, last_mps)).unwrap();
    recorder.record(driven(8, 0.3)).unwrap();
    recorder.finish().unwrap();
}

#[test]
fn check_and_verify_accept_wheel_speeds_and_refute_another_speed_or_byte() {
    let desk = Desk::new();
    record_wheels(&desk, "run", 0.3);
    desk.ok(&format!("recording check {FILES}"));
    let said = desk.ok(&format!("recording verify {FILES}"));
    assert!(
        said.contains("3 of 3 recordings are bit-identical"),
        "{said}"
    );
    let of = |topic| messages::said(&desk.recording("run/ep-0001.mcap"), topic);
    assert_eq!(of("/step").len(), 60);
    assert!(of("/contact").len() > 2, "control: the robot hits a wall");
    let (_, rule) = &of("/rule")[0];
    assert_eq!(rule["rule"], "wheels -> left 0.80 m/s, right 0.30 m/s");
    let mut bytes = std::fs::read(desk.path("run/ep-0001.mcap")).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(desk.path("run/ep-0001.mcap"), bytes).unwrap();
    desk.run(1, "recording verify @run/ep-0001.mcap");
    record_wheels(&desk, "other", 0.31);
    std::fs::rename(desk.path("run/run.mcap"), desk.path("other/run.mcap")).unwrap();
    let (said, _) = desk.run(1, "recording verify @other/ep-0001.mcap");
    assert!(said.contains("ep-0001.mcap"), "{said}");
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
fn a_recording_without_a_policy_gives_no_rules() {
    let desk = recorded(ArenaKind::Grid);
    let line = "rules list @run/run.mcap";
    let code = desk.output(line).status.code().unwrap();
    assert_ne!(code, 0);
    desk.fails(code, line, "");
}

#[test]
fn after_an_episode_that_goes_on_behind_the_goal_the_whole_recording_fails() {
    let desk = Desk::new();
    let mut plan = plan(ArenaKind::Grid);
    plan.config.settings.arena.slip = 0.0;
    let mut recorder = recorder(desk.folder(), &plan);
    let to_the_goal = [1, 2, 2, 2, 1, 1, 1, 1, 2, 2];
    recorder.record(episode(7, &to_the_goal)).unwrap();
    let on = [&to_the_goal[..], &[1]].concat();
    for _ in 0..2 {
        let fault = recorder.record(episode(8, &on)).unwrap_err().to_string();
        assert!(fault.contains("at the goal after 10 steps"), "{fault}");
    }
    let fault = recorder.record(episode(9, &to_the_goal)).unwrap_err();
    assert!(fault.to_string().contains("episode 2: "), "{fault}");
    let fault = recorder.finish().unwrap_err();
    assert!(fault.to_string().contains("episode 2: "), "{fault}");
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
        driven(1, 0.3),
    ] {
        let fault = recorder.record(episode).unwrap_err().to_string();
        assert!(fault.contains("episode 1: "), "{fault}");
    }
    drop(recorder);
    let physics = Plan::new(maze("maze4")).arena(ArenaKind::Physics);
    for (sensor, speed, words) in [
        (Sensor::Lidar, 0.3, "estimate its pose"),
        (Sensor::Neighbours, f64::NAN, "finite number"),
    ] {
        let physics = physics.clone().sensor(sensor);
        let mut recorder = self::recorder(&desk.path(words), &physics);
        let fault = recorder.record(driven(1, speed)).unwrap_err().to_string();
        assert!(fault.contains(words), "{fault}");
    }
    let again = ExternalRecorder::create(desk.folder(), &plan, RecordMode::All);
    let fault = again.err().unwrap().to_string();
    assert!(fault.contains("the folder contains files"), "{fault}");
}
