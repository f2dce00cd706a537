//! What `train` writes: the same bytes, which `verify` makes again, and policies as good as it says. What it says is in
//! `training.txt`.

use crate::kit::desk::Desk;
use crate::kit::folder::names;
use crate::kit::messages::count;
use crate::kit::trial::maze;
use xcscr::agent::Method;
use xcscr::arena::ArenaKind;
use xcscr::sensor::Sensor;
use xcscr::trial::{Plan, Settings};

/// How many messages of a topic the episodes of a run have.
fn in_episodes(desk: &Desk, run: &str, topic: &str) -> [u64; 2] {
    [1, 2].map(|number| {
        count(
            &desk.recording(&format!("{run}/ep-000{number}.mcap")),
            topic,
        )
    })
}

#[test]
fn beams_are_recorded_when_they_are_asked_for_and_are_the_same_in_a_new_run() {
    let desk = Desk::new();
    desk.train("with", "maze4 --episodes 2 --record beams");
    desk.train("without", "maze4 --episodes 2");
    let steps = in_episodes(&desk, "with", "/step");
    // A move takes some 24 physics steps, and each has beams.
    for (steps, scans) in steps.iter().zip(in_episodes(&desk, "with", "/scan")) {
        let range = 12 * steps..60 * steps;
        assert!(range.contains(&scans), "{scans} in {steps}");
    }
    assert_eq!(in_episodes(&desk, "without", "/scan"), [0, 0], "control");
    desk.ok("recording check @with/ep-0002.mcap");
    desk.ok("recording verify @with");
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
                let makes_sense = is_drivable || arena != ArenaKind::Physics;
                match result {
                    Ok(trial) => {
                        assert!(makes_sense, "{what} ran");
                        assert_eq!(trial.progress().episodes, 2, "{what}");
                    }
                    Err(error) => {
                        let said = error.to_string();
                        assert!(
                            !makes_sense && said.contains("--arena grid"),
                            "{what}: {said}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn replay_verify_accepts_a_run_and_notices_one_changed_byte() {
    let desk = Desk::new();
    desk.train("run", "maze4 --episodes 5 --seed 3");
    let stdout = desk.ok("recording verify @run");
    assert_eq!(stdout, "6 of 6 recordings are bit-identical to a new run\n");
    let name = "run/ep-0004.mcap";
    let sound = desk.read(name);
    for at in [10, sound.len() / 3, sound.len() / 2, sound.len() - 20] {
        let mut bytes = sound.clone();
        bytes[at] ^= 1;
        desk.write(name, bytes);
        let (stdout, _) = desk.run(1, "recording verify @run");
        assert!(stdout.contains("ep-0004.mcap: "), "byte {at}: {stdout}");
        desk.run(1, "recording verify @run/ep-0004.mcap");
    }
    desk.write(name, sound);
    desk.ok("recording verify @run/ep-0004.mcap");
}

#[test]
fn the_rules_of_a_recorded_episode_are_those_of_then_and_of_the_last_one_those_of_the_run() {
    let desk = Desk::new();
    let run = desk.train("run", "maze4 --arena grid --episodes 3");
    let recordings = names(&run)
        .into_iter()
        .filter(|name| name.ends_with(".mcap"));
    let checked = desk.ok("recording check @run");
    assert_eq!(checked.lines().count(), recordings.count(), "{checked}");
    let of_run = desk.ok("rules @run");
    assert_eq!(of_run, desk.ok("rules @run/ep-0003.mcap"));
    assert_ne!(of_run, desk.ok("rules @run/ep-0001.mcap"), "control");
}
