//! A robot that only senses: what a cell move costs, and how far it is mistaken.
//!
//! `cargo bench --bench sensed -- WORLD MOVES SEED robot=NAME SETTING=VALUE...` makes random moves in a world
//! (a name below `worlds/`, a generated one or an absolute path, without `.json`) and prints, as JSON, the processor time of a move with its percept and what went wrong in how many.
//! The same seed gives the same figures, but for the time.

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use serde_json::json;
use xcscr::arena::{Arena, Localisation, PhysicsArena};
use xcscr::sensor::Sensor;
use xcscr::trial::{Resolved, RobotProfile, Settings};
use xcscr::world::Maze;
use xcscr::xcs::Action;

#[path = "../tests/kit/tally.rs"]
mod tally;

use tally::{Tally, mean, quantile, script, true_cell};

const WORLDS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/worlds");

/// Processor time of this thread in seconds; where the system does not tell, time on the wall.
fn seconds(since: Instant) -> f64 {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let ns = told.and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    ns.map_or(since.elapsed().as_secs_f64(), |ns| ns / 1e9)
}

/// Microseconds of a move with its percept; a robot in a goal is put back to the start.
fn microseconds_a_move(arena: &mut PhysicsArena, actions: &[Action]) -> f64 {
    let start = arena.view().maze.start_cells()[0];
    arena.reset(start);
    let began = Instant::now();
    let before = seconds(began);
    for &action in actions {
        arena.act(action);
        let view = arena.view();
        std::hint::black_box(Sensor::Lidar.perceive(&view));
        if view.maze.is_goal(true_cell(&view)) {
            arena.reset(start);
        }
    }
    (seconds(began) - before) / actions.len() as f64 * 1e6
}

fn main() -> Result<(), Box<dyn Error>> {
    // Cargo adds `--bench` to the arguments.
    let words = std::env::args().skip(1).filter(|arg| arg != "--bench");
    let (sets, words): (Vec<String>, Vec<String>) = words.partition(|word| word.contains('='));
    let world = words.first().map_or("maze4", String::as_str);
    let number = |at: usize, default| words.get(at).map_or(Ok(default), |word| word.parse());
    let (moves, seed) = (number(1, 20_000)?, number(2, 1)?);
    let maze = match world.parse::<xcscr::world::Recipe>() {
        Ok(recipe) => recipe.maze()?,
        Err(_) => Maze::load(&Path::new(WORLDS).join(format!("{world}.json")))?,
    };
    let (robots, sets): (Vec<String>, Vec<String>) =
        sets.into_iter().partition(|set| set.starts_with("robot="));
    let robot = robots
        .last()
        .map_or("default", |robot| &robot["robot=".len()..]);
    let robot_settings = RobotProfile::load(robot)?.settings_over(&Settings::default())?;
    let mut params = Resolved::new(&robot_settings, &[], &sets)?.settings.physics;
    params.localisation = Localisation::Estimated;
    let arena = || PhysicsArena::new(maze.clone(), params.clone(), seed as u64);
    let actions: Vec<Action> = script(seed as u64, moves).collect();
    let cost = microseconds_a_move(&mut arena()?, &actions);
    let mut tally = Tally::of(&mut arena()?, seed as u64, moves);
    let report = json!({
        "world": world, "robot": robot, "moves": moves, "seed": seed, "set": sets,
        "us_a_move": (100.0 * cost).round() / 100.0,
        "steps_a_move": tally.steps as f64 / moves as f64,
        "wrong_moves": tally.wrong, "wrong_cells": tally.wrong_cell,
        "wrong_outcomes": tally.wrong_outcome, "lost": tally.lost,
        "wrong_percepts": tally.wrong_percepts,
        "error_cm": { "mean": mean(&tally.error_cm), "p99": quantile(&mut tally.error_cm, 0.99), "max": quantile(&mut tally.error_cm, 1.0) },
        "heading_deg_p99": quantile(&mut tally.heading_deg, 0.99),
        "nees": mean(&tally.nees),
    });
    println!("{report}");
    Ok(())
}
