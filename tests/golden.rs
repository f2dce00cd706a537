//! Digests of trained runs: all methods and both arenas; and some of a robot that senses. The fast suite
//! has one maze of each, the long suite has all.
//!
//! Each digest covers what was learned (the text of `rules.json`), the figures of every episode,
//! and time and pose after every step, all with their last bit. A change here means that the same seed gives other
//! results than before: other users' recordings no longer verify, and tables made with an earlier
//! version no longer reproduce. That may be right (a fault in an algorithm was found), but never
//! by accident: say in the commit what changed the results, and raise the version.
//!
//! The digests are the same in debug and release and on every platform with IEEE numbers: run
//! `cargo test --release --test suite golden::`, too.

use std::hash::Hasher;
use std::ops::ControlFlow;
use std::path::Path;

use fnv::FnvHasher;
use xcscr::agent::Method;
use xcscr::arena::ArenaKind;
use xcscr::episode::{AfterEpisode, Episode, Observer, Step};
use xcscr::sensor::Sensor;
use xcscr::trial::{Plan, Trial};
use xcscr::world::Maze;

use crate::kit::chance::rounds;

/// FNV-1a, 64 bits: short, and enough to notice a change.
#[derive(Default)]
struct Digest(FnvHasher);

impl Digest {
    fn add(&mut self, bytes: &[u8]) {
        self.0.write(bytes);
    }
}

impl Observer for Digest {
    fn stepped(&mut self, step: &Step<'_>) {
        let now = step.view.now();
        let pose = now.robot_in_map.to_homogeneous();
        self.add(&now.time_ns.to_le_bytes());
        pose.iter()
            .for_each(|number| self.add(&number.to_bits().to_le_bytes()));
    }

    fn ended(&mut self, episode: &Episode, _: &AfterEpisode<'_>) -> ControlFlow<()> {
        let figures = [
            episode.steps.into(),
            episode.collisions.into(),
            episode.explored.into(),
            episode.reward.to_bits(),
            episode.step_threshold.into(),
            episode.rules as u64,
            episode.imprinted.into(),
        ];
        figures
            .iter()
            .for_each(|figure: &u64| self.add(&figure.to_le_bytes()));
        ControlFlow::Continue(())
    }
}

fn digest(world: &str, method: Method, arena: ArenaKind, sensor: Sensor) -> String {
    let path = format!("{}/worlds/{world}.json", env!("CARGO_MANIFEST_DIR"));
    let maze = Maze::load(Path::new(&path)).unwrap();
    let plan = Plan::new(maze).method(method).arena(arena).sensor(sensor);
    let mut trial = Trial::new(plan.episodes(60)).unwrap();
    let mut digest = Digest::default();
    let _ = trial.run(&mut digest);
    let rules = serde_json::to_string_pretty(&trial.method().knowledge()).unwrap();
    digest.add(rules.as_bytes());
    let (method, arena) = (method.name(), arena.name());
    let words = match sensor {
        Sensor::Neighbours => arena.to_owned(),
        sensed => format!("{arena} {}", sensed.name()),
    };
    format!("{world} {method} {words} {:016x}", digest.0.finish())
}

#[test]
fn trained_runs_of_all_methods_keep_their_digests_in_both_arenas() {
    for world in ["maze4", "maze5", "maze6"].iter().take(rounds([1, 3, 3])) {
        let of_method = |&method| {
            let digest = |&arena| digest(world, method, arena, Sensor::Neighbours);
            ArenaKind::ALL.iter().map(digest).collect::<Vec<_>>()
        };
        let found: Vec<String> = Method::ALL.iter().flat_map(of_method).collect();
        insta::assert_snapshot!(format!("trained_runs_in_{world}"), found.join("\n"));
    }
}

#[test]
fn a_robot_that_only_senses_keeps_its_digests_on_dry_and_on_slippery_floor() {
    let methods = [Method::Xcscr, Method::XcscrPlus, Method::QLearning];
    let worlds = ["maze5-wet", "maze4", "maze5", "maze6"];
    for world in worlds.iter().take(rounds([1, 4, 4])) {
        let digest = |method| digest(world, method, ArenaKind::Physics, Sensor::Lidar);
        let found = methods.map(digest).join("\n");
        insta::assert_snapshot!(format!("sensing_in_{world}"), found);
    }
}
