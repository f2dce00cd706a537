//! What a physics step of one robot costs when many drive at once.
//!
//! `cargo bench --bench batch` lets K robots drive at random through Maze4 and prints, as rows of a
//! table, microseconds of CPU per robot and physics step, of all that an action needs: median of five
//! rounds, in which all take turns. `cargo bench --bench batch -- K SHORTCUT MOVES` does only one of
//! them, once, for a profile. `cargo bench --bench batch -- K MOVES` lets K robots drive episodes of at
//! most 50 moves, and prints microseconds per robot and move: the work of the Python environments.

mod clock;

use std::error::Error;
use std::path::Path;

use clock::cpu_ns;
use xcscr::arena::{Arena, BatchArena, Outcome, PhysicsArena, PhysicsParams};
use xcscr::streams::StreamName;
use xcscr::world::Maze;
use xcscr::xcs::Action;
use xcscr::xcs::random::Stream;

const WORLD: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/worlds/maze4.json");
/// A physics step lasts 50 ms.
const STEP_NS: u64 = 50_000_000;
const LANES: [usize; 4] = [1, 8, 32, 64];
const ROUNDS: usize = 5;
/// Moves of all robots together.
const MOVES: usize = 32_000;

/// The arena alone, or so many lanes.
#[derive(Clone, Copy)]
enum Robots {
    Alone,
    Lanes(usize),
}

fn main() -> Result<(), Box<dyn Error>> {
    // Cargo adds `--bench` to the arguments.
    let numbers = std::env::args().skip(1).filter(|arg| arg != "--bench");
    let numbers: Vec<usize> = numbers.map(|arg| arg.parse()).collect::<Result<_, _>>()?;
    if let [lanes, shortcut, moves] = numbers[..] {
        let us = microseconds(Robots::Lanes(lanes), shortcut == 1, moves)?;
        println!("{us:.3}");
        return Ok(());
    }
    if let [lanes, moves] = numbers[..] {
        println!("{:.3}", microseconds_of_episodes(lanes, moves)?);
        return Ok(());
    }
    let all = LANES.map(Robots::Lanes);
    let all: Vec<Robots> = [Robots::Alone].into_iter().chain(all).collect();
    for shortcut in [false, true] {
        let mut found = vec![Vec::new(); all.len()];
        for _ in 0..ROUNDS {
            for (found, &robots) in found.iter_mut().zip(&all) {
                found.push(microseconds(robots, shortcut, MOVES)?);
            }
        }
        let medians = found.into_iter().map(|us| format!(" {:.2} |", median(us)));
        let name = if shortcut { "with" } else { "without" };
        println!("| {name} the shortcut |{}", medians.collect::<String>());
    }
    Ok(())
}

/// CPU time per robot and physics step.
fn microseconds(robots: Robots, shortcut: bool, moves: usize) -> Result<f64, Box<dyn Error>> {
    let maze = Maze::load(Path::new(WORLD))?;
    let params = PhysicsParams {
        shortcut,
        ..PhysicsParams::default()
    };
    let mut stream = Stream::new(1, StreamName::Exploration);
    let mut draw = || Action::new(stream.below(4)).ok_or("there are four actions");
    let (begin, steps);
    match robots {
        Robots::Alone => {
            let mut arena = PhysicsArena::new(maze, params, 1)?;
            begin = cpu_ns()?;
            for _ in 0..moves {
                arena.act(draw()?);
            }
            steps = arena.view().now().time_ns / STEP_NS;
        }
        Robots::Lanes(count) => {
            let seeds: Vec<u64> = (1..=count as u64).collect();
            let mut batch = BatchArena::new(&maze, &params, &seeds)?;
            begin = cpu_ns()?;
            for _ in 0..moves / count {
                let actions: Vec<Action> = (0..count).map(|_| draw()).collect::<Result<_, _>>()?;
                batch.act(&actions);
            }
            steps = batch.lanes().times_ns.iter().sum::<u64>() / STEP_NS;
        }
    }
    Ok((cpu_ns()? - begin) as f64 / 1000.0 / steps as f64)
}

/// CPU time per robot and move, where an episode ends at a goal or after 50 moves.
fn microseconds_of_episodes(count: usize, moves: usize) -> Result<f64, Box<dyn Error>> {
    const LIMIT: usize = 50;
    let maze = Maze::load(Path::new(WORLD))?;
    let start = maze.start().ok_or("the maze has one start")?;
    let mut stream = Stream::new(1, StreamName::Exploration);
    let seeds: Vec<u64> = (1..=count as u64).collect();
    let mut batch = BatchArena::new(&maze, &PhysicsParams::default(), &seeds)?;
    (0..count).for_each(|lane| batch.reset(lane, start));
    let mut lengths = vec![0; count];
    let begin = cpu_ns()?;
    for _ in 0..moves / count {
        let actions =
            (0..count).map(|_| Action::new(stream.below(4)).ok_or("there are four actions"));
        let actions: Vec<Action> = actions.collect::<Result<_, _>>()?;
        let outcomes = batch.act(&actions).outcomes.clone();
        for (lane, outcome) in outcomes.into_iter().enumerate() {
            lengths[lane] += 1;
            if outcome == Some(Outcome::ReachedGoal) || lengths[lane] == LIMIT {
                batch.reset(lane, start);
                lengths[lane] = 0;
            }
        }
    }
    Ok((cpu_ns()? - begin) as f64 / 1000.0 / (moves / count * count) as f64)
}

/// The middle one of some measurements.
fn median(mut found: Vec<f64>) -> f64 {
    found.sort_by(f64::total_cmp);
    found.get(found.len() / 2).copied().unwrap_or(f64::NAN)
}
