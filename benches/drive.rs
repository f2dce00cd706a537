//! Physics steps of one robot, for `peers.py`.
//!
//! `cargo bench --bench drive -- PUSHING SHORTCUT MOVES` drives east and west through a free
//! corridor of Maze4 (`PUSHING` 0) or again and again into a wall (1), with the exact shortcut
//! (`SHORTCUT` 1) or without (0), and prints as JSON how many physics steps that took.

use std::error::Error;
use std::path::Path;

use serde_json::json;
use xcscr::arena::{Arena, PhysicsArena, PhysicsParams};
use xcscr::world::{Cell, Direction, Maze};
use xcscr::xcs::Action;

const WORLD: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/worlds/maze4.json");
/// A physics step lasts 50 ms.
const STEP_NS: u64 = 50_000_000;

fn main() -> Result<(), Box<dyn Error>> {
    // Cargo adds `--bench` to the arguments.
    let numbers = std::env::args().skip(1).filter(|arg| arg != "--bench");
    let numbers: Vec<u64> = numbers.map(|arg| arg.parse()).collect::<Result<_, _>>()?;
    let number = |at: usize, default| numbers.get(at).copied().unwrap_or(default);
    let (pushing, shortcut, moves) = (number(0, 0) == 1, number(1, 1) == 1, number(2, 4000));
    let maze = Maze::load(Path::new(WORLD))?;
    let params = PhysicsParams {
        shortcut,
        ..PhysicsParams::default()
    };
    let action = |wanted| {
        let means = |action: &Action| maze.direction(*action) == Some(wanted);
        Action::all(maze.action_count()).find(means)
    };
    let toward = [Direction::East, Direction::West, Direction::North].map(action);
    let [Some(east), Some(west), Some(north)] = toward else {
        return Err("the world has no main directions".into());
    };
    let mut arena = PhysicsArena::new(maze, params, 1)?;
    // Row 4 is free from column 1 to 6; a wall lies north of column 3.
    arena.reset(Cell { col: 3, row: 4 });
    for step in 0..moves {
        arena.act(match (pushing, step % 2) {
            (true, _) => north,
            (false, 0) => east,
            (false, _) => west,
        });
    }
    let physics_steps = arena.view().now().time_ns / STEP_NS;
    println!(
        "{}",
        json!({ "moves": moves, "physics_steps": physics_steps })
    );
    Ok(())
}
