//! The arenas, the recorder and whole trials.

use std::fmt;
use std::path::Path;

use divan::Bencher;
use xcscr::agent::Method;
use xcscr::arena::ArenaKind;
use xcscr::arena::{Arena, GridArena, PhysicsArena, PhysicsParams};
use xcscr::record::{RecordMode, Recorder, RobotShape, RunInfo, RunKind};
use xcscr::sensor::Sensor;
use xcscr::trial::{Plan, Trial};
use xcscr::world::{Cell, Maze};
use xcscr::xcs::Action;

const WORLD: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/worlds/maze4.json");
/// The corridor of Maze4, with a wall to its north.
const CORRIDOR: Cell = Cell { col: 3, row: 4 };
/// Moves to the north and, there and back again, along the corridor.
const PUSHING: [usize; 2] = [0, 0];
const FREE: [usize; 2] = [1, 3];

fn main() {
    divan::main();
}

fn maze() -> Maze {
    Maze::load(Path::new(WORLD)).expect("the world comes with the sources")
}

fn cell_moves(bencher: Bencher, mut arena: impl Arena, moves: [usize; 2]) {
    arena.reset(CORRIDOR);
    let mut moves = moves.into_iter().filter_map(Action::new).cycle();
    bencher.bench_local(|| moves.next().map(|action| arena.act(action)));
}

#[divan::bench]
fn grid_cell_move(bencher: Bencher) {
    cell_moves(bencher, GridArena::new(maze()), FREE);
}

#[divan::bench(args = [false, true])]
fn physics_cell_move_free_with_shortcut(bencher: Bencher, shortcut: bool) {
    physics_cell_moves(bencher, FREE, shortcut);
}

#[divan::bench(args = [false, true])]
fn physics_cell_move_pushing_with_shortcut(bencher: Bencher, shortcut: bool) {
    physics_cell_moves(bencher, PUSHING, shortcut);
}

fn physics_cell_moves(bencher: Bencher, moves: [usize; 2], shortcut: bool) {
    let params = PhysicsParams {
        shortcut,
        ..PhysicsParams::default()
    };
    let arena = PhysicsArena::new(maze(), params, 1);
    cell_moves(bencher, arena.expect("Maze4 fits into physics"), moves);
}

/// A method that divan can print and copy.
#[derive(Clone, Copy)]
struct Named(Method);

impl fmt::Display for Named {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.name())
    }
}

fn plan(method: Method, arena: ArenaKind) -> Plan {
    let plan = Plan::new(maze()).method(method);
    plan.arena(arena).sensor(Sensor::Neighbours)
}

fn train(plan: Plan, mode: RecordMode) -> Trial {
    let folder = tempfile::tempdir().expect("there is room for a recording");
    let info = RunInfo {
        world_json: plan.maze.to_json(),
        config_json: String::new(),
        seed: plan.config.seed,
        method: plan.config.method.name().to_owned(),
        arena: plan.config.arena.name().to_owned(),
        sensor: plan.config.sensor,
        episodes: plan.config.episodes,
        robot: RobotShape::for_cell(plan.maze.cell_size_m()),
        slip: 0.0,
        goal: 1000.0,
        kind: RunKind::Training,
    };
    let recorder = Recorder::create(folder.path(), &plan.maze, info, mode);
    let mut recorder = recorder.expect("there is room for a recording");
    let mut trial = Trial::new(plan).expect("the default settings are in range");
    let _ = trial.run(&mut recorder);
    let written = recorder.finish(trial.method());
    written.expect("there is room for a recording");
    trial
}

#[divan::bench(args = Method::ALL.iter().copied().map(Named), sample_count = 10, sample_size = 1)]
fn trial_on_the_grid(bencher: Bencher, Named(method): Named) {
    bencher.bench(|| train(plan(method, ArenaKind::Grid), RecordMode::None));
}

#[divan::bench(args = Method::ALL.iter().copied().map(Named), sample_count = 10, sample_size = 1)]
fn trial_in_physics(bencher: Bencher, Named(method): Named) {
    bencher.bench(|| train(plan(method, ArenaKind::Physics), RecordMode::None));
}

#[divan::bench(args = Method::ALL.iter().copied().map(Named), sample_count = 10, sample_size = 1)]
fn recorded_trial_in_physics(bencher: Bencher, Named(method): Named) {
    bencher.bench(|| train(plan(method, ArenaKind::Physics), RecordMode::All));
}
