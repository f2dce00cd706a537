//! A learner with a map that senses: a lidar shows neither goals nor hidden corners.

use std::sync::Arc;

use xcscr::agent::{Method, MotionPrior};
use xcscr::arena::ArenaKind;
use xcscr::sensor::Sensor;
use xcscr::trial::Plan;

use crate::learned::{Learned, drawn, learned, mapped, with, world};

/// A plan on the percept `lidar`.
fn plan(name: &str, method: Method, episodes: u32) -> Plan {
    let plan = mapped(world(name), method).sensor(Sensor::Lidar);
    let plan = plan.episodes(episodes);
    with(plan, |settings| settings.physics.noise = 3.0)
}

/// What is learned with a map, and with a table.
fn both(plan: impl Fn(Method) -> Plan) -> [Arc<Learned>; 2] {
    [Method::XcscrPlus, Method::QLearning].map(|method| learned(plan(method)))
}

#[test]
fn a_robot_that_only_senses_is_optimal_once_it_has_a_map() {
    for world in ["maze4", "maze5", "maze6"] {
        let plan = |method| plan(world, method, 4).arena(ArenaKind::Physics);
        let [trial, without] = both(plan);
        assert!(trial.progress.optimal, "{world}: {:?}", trial.progress);
        assert!(trial.rules <= 25, "{world}");
        assert!(!without.progress.optimal, "control: {world}");
    }
}

#[test]
fn who_learns_that_all_episodes_begin_in_one_place_is_optimal_in_rooms_that_look_alike() {
    let [trial, without] = both(|method| plan("rooms-20-1", method, 12));
    assert!(trial.progress.optimal, "{:?}", trial.progress);
    assert!(trial.rules <= 50 && trial.knows_its_start());
    assert!(!without.progress.optimal, "control");
}

/// Of a start in a dead end a lidar shows one free cell, and hides the corners.
#[test]
fn who_does_not_know_its_moves_gets_out_of_a_dead_end() {
    let maze = drawn(&["######", "#S...#", "###G##", "######"]);
    for seed in 1..=5 {
        let plan = mapped(maze.clone(), Method::XcscrPlus).seed(seed);
        let plan = with(plan.sensor(Sensor::Lidar).episodes(20), |settings| {
            settings.map.motion_model = MotionPrior::Learned;
        });
        let progress = &learned(plan).progress;
        let is_out = progress.optimal && progress.collisions < 60;
        assert!(is_out, "seed {seed}: {progress:?}");
    }
}

/// What is learned in a corridor of thirty cells, of which all but the ends and those at the goal's niche look
/// alike.
fn in_a_corridor(seed: u64, slip: f64) -> Arc<Learned> {
    let wall = "#".repeat(32);
    let niche = format!("{}G{}", "#".repeat(8), "#".repeat(23));
    let corridor = format!("#{}S{}#", ".".repeat(14), ".".repeat(15));
    let maze = drawn(&[wall.as_str(), &niche, &corridor, &wall]);
    let plan = mapped(maze, Method::XcscrPlus).sensor(Sensor::Lidar);
    let plan = with(plan, |settings| settings.arena.slip = slip);
    learned(plan.episodes(30).seed(seed).settled())
}

#[test]
fn in_a_corridor_of_cells_that_look_alike_only_moves_that_slip_are_held_for_slipping() {
    for seed in 1..=4 {
        let trial = in_a_corridor(seed, 0.0);
        assert_eq!(trial.slip(), 0.0, "seed {seed}");
        assert!(trial.progress.optimal, "seed {seed}: {:?}", trial.progress);
        let slip = in_a_corridor(seed, 0.25).slip();
        assert!((slip - 0.25).abs() < 0.08, "control: seed {seed}: {slip}");
    }
}
