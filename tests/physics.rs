//! What the simulated robot does: it drives where it is told to, knows when it hits a wall, and
//! does the same again, to the bit.

use std::path::Path;

use xcscr::arena::{Arena, Outcome, PhysicsArena, PhysicsParams};
use xcscr::random::{Stream, StreamName};
use xcscr::signal::Action;
use xcscr::world::{Cell, Maze};

const MAZES: [&str; 3] = ["maze4", "maze5", "maze6"];

fn maze(name: &str) -> Maze {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("worlds/{name}.json"));
    Maze::load(&file).unwrap()
}

fn arena_in(maze: Maze, params: PhysicsParams, seed: u64) -> PhysicsArena {
    PhysicsArena::new(maze, params, Stream::new(seed, StreamName::Physics)).unwrap()
}

fn arena(world: &str, params: PhysicsParams, seed: u64) -> PhysicsArena {
    arena_in(maze(world), params, seed)
}

fn with_noise(noise: f64) -> PhysicsParams {
    PhysicsParams {
        noise,
        ..PhysicsParams::default()
    }
}

/// Random actions that do not depend on what the arena does with them.
fn script(seed: u64, length: usize) -> impl Iterator<Item = Action> {
    let mut stream = Stream::new(seed, StreamName::Exploration);
    (0..length).map(move |_| Action::new(stream.below(4)).unwrap())
}

/// How often the robot did something else than what it was told, and how far off it ended.
#[derive(Debug, Default)]
struct Tally {
    free: u32,
    bumps: u32,
    wrong_cell: u32,
    false_collisions: u32,
    missed_collisions: u32,
    stalled: u32,
    steps: u64,
    largest_offset_m: f64,
}

impl Tally {
    fn faults(&self) -> u32 {
        self.wrong_cell + self.false_collisions + self.missed_collisions + self.stalled
    }
}

/// Random moves; in a goal the robot starts again.
fn wander(mut arena: PhysicsArena, seed: u64, moves: usize) -> Tally {
    let mut tally = Tally::default();
    for action in script(seed, moves) {
        let maze = arena.view().maze;
        let cell = arena.view().cell;
        let expected = maze.step(cell, maze.direction(action).unwrap());
        let outcome = arena.act(action);
        let view = arena.view();
        tally.steps += view.trace.len() as u64 - 1;
        match (outcome, expected) {
            (Outcome::Stalled, _) => tally.stalled += 1,
            (Outcome::Collided { .. }, Some(_)) => tally.false_collisions += 1,
            (Outcome::Collided { .. }, None) => tally.bumps += 1,
            (_, None) => tally.missed_collisions += 1,
            (_, Some(_)) => tally.free += 1,
        }
        let position = view.now().robot_in_world.translation.vector.into();
        let truth = expected.unwrap_or(cell);
        tally.wrong_cell += u32::from(view.maze.cell_at(position) != Some(truth));
        let offset = (view.maze.centre_m(truth) - position).norm();
        tally.largest_offset_m = tally.largest_offset_m.max(offset / view.maze.cell_size_m());
        if view.maze.is_goal(view.cell) || tally.stalled + tally.wrong_cell > 0 {
            let start = view.maze.start_cells()[0];
            arena.reset(start);
        }
    }
    assert!(!arena.lost_robot());
    tally
}

#[test]
fn ten_thousand_noisy_moves_end_where_they_should() {
    for world in MAZES {
        for seed in 1..=1 {
            let tally = wander(arena(world, PhysicsParams::default(), seed), seed, 10_000);
            println!("{world}: {tally:?}");
            assert_eq!(tally.faults(), 0, "{world}, seed {seed}: {tally:?}");
        }
    }
}
