//! What every arena promises, checked by one checker over the grid and the simulated robot.

use std::path::Path;

use xcscr::arena::{Arena, GridArena, Outcome, PhysicsArena, PhysicsParams};
use xcscr::streams::StreamName;
use xcscr::world::{Cell, Maze};
use xcscr::xcs::Action;
use xcscr::xcs::random::Stream;

const MAZES: [&str; 3] = ["maze4", "maze5", "maze6"];
const EPISODES: u64 = 30;
const ACTIONS: usize = 40;

fn maze(name: &str) -> Maze {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("worlds/{name}.json"));
    Maze::load(&file).unwrap()
}

fn robot(maze: &Maze, noise: f64, shortcut: bool) -> PhysicsArena {
    let params = PhysicsParams {
        noise,
        shortcut,
        ..PhysicsParams::default()
    };
    PhysicsArena::new(maze.clone(), params, 1).unwrap()
}

/// An outcome without the numbers that only some arenas have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Moved,
    FoundReward,
    Collided,
    Stalled,
    ReachedGoal,
}

impl From<Outcome> for Kind {
    fn from(outcome: Outcome) -> Self {
        match outcome {
            Outcome::Moved => Self::Moved,
            Outcome::FoundReward { .. } => Self::FoundReward,
            Outcome::Collided { .. } => Self::Collided,
            Outcome::Stalled => Self::Stalled,
            Outcome::ReachedGoal => Self::ReachedGoal,
        }
    }
}

/// What an arena made of each action: the outcome, the cell, and the bits of the last pose.
type Course = Vec<(Kind, Cell, [u64; 3])>;

/// Random episodes from random free cells, each ended by the goal, and the promises kept in each.
fn course(arena: &mut dyn Arena) -> Course {
    let mut random = Stream::new(1, StreamName::Exploration);
    let starts: Vec<Cell> = {
        let maze = arena.view().maze;
        maze.free_cells().filter(|&c| !maze.is_goal(c)).collect()
    };
    let mut course = Vec::new();
    for episode in 0..EPISODES {
        let clock_ns = arena.view().now().time_ns;
        let start = starts[random.below(starts.len())];
        arena.reset(start);
        check_reset(arena, start, clock_ns);
        for step in 0..ACTIONS {
            let action = Action::new(random.below(4)).unwrap();
            let (from, clock_ns) = (arena.view().cell, arena.view().now().time_ns);
            let outcome = arena.act(action);
            let situation = format!("episode {episode}, step {step}, {from:?}, {action:?}");
            check_step(arena, outcome, from, clock_ns, &situation);
            course.push(entry(arena, outcome));
            if outcome == Outcome::ReachedGoal {
                break;
            }
        }
    }
    course
}

fn entry(arena: &dyn Arena, outcome: Outcome) -> (Kind, Cell, [u64; 3]) {
    let view = arena.view();
    let pose = view.now().robot_in_map;
    let (at, turn) = (pose.translation, pose.rotation);
    let bits = [at.x, at.y, turn.im].map(f64::to_bits);
    (outcome.into(), view.cell, bits)
}

/// A reset puts the robot at rest into the middle of the cell, and does not touch the clock.
fn check_reset(arena: &dyn Arena, start: Cell, clock_ns: u64) {
    let view = arena.view();
    let at = view.now().robot_in_map;
    assert_eq!(view.cell, start);
    assert_eq!(at.translation.vector, view.maze.centre_m(start).coords);
    assert_eq!((at.rotation.re, at.rotation.im), (1.0, 0.0), "heads east");
    assert_eq!(view.now().time_ns, clock_ns);
    assert_eq!(view.now().wheel_travel_m, [0.0; 2]);
    assert!(view.contacts.is_empty());
}

/// The outcome tells where the robot stands, and the path begins where and when the last ended.
fn check_step(arena: &dyn Arena, outcome: Outcome, from: Cell, clock_ns: u64, situation: &str) {
    let view = arena.view();
    let is_goal = view.maze.is_goal(view.cell);
    match outcome {
        Outcome::Moved | Outcome::FoundReward { .. } => {
            assert!(view.cell != from && !is_goal, "{situation}")
        }
        Outcome::Collided { impulse_ns } => {
            assert_eq!(view.cell, from, "{situation}");
            assert!(
                impulse_ns.is_none_or(|impulse| impulse > 0.0),
                "{situation}"
            );
            assert_eq!(impulse_ns.is_some(), !view.contacts.is_empty());
        }
        Outcome::ReachedGoal => assert!(is_goal, "{situation}"),
        Outcome::Stalled => panic!("no time is short here: {situation}"),
    }
    assert_eq!(view.trace[0].time_ns, clock_ns, "{situation}");
    let ordered = view.trace.is_sorted_by(|a, b| a.time_ns < b.time_ns);
    assert!(ordered && view.trace.len() > 1, "{situation}");
}

fn facts(course: &Course) -> Vec<(Kind, Cell)> {
    course.iter().map(|&(kind, cell, _)| (kind, cell)).collect()
}

#[test]
fn grid_and_robot_agree_on_every_outcome_and_cell() {
    for name in MAZES {
        let maze = maze(name);
        let grid = course(&mut GridArena::new(maze.clone()));
        for shortcut in [true, false] {
            let robot = course(&mut robot(&maze, 0.0, shortcut));
            assert_eq!(facts(&robot), facts(&grid), "{name}, shortcut {shortcut}");
        }
        let noisy = course(&mut robot(&maze, 1.0, true));
        assert_eq!(facts(&noisy), facts(&grid), "{name} with noise");
    }
}

#[test]
fn the_script_has_moves_collisions_and_goals() {
    let course = course(&mut GridArena::new(maze("maze4")));
    for kind in [Kind::Moved, Kind::Collided, Kind::ReachedGoal] {
        let count = course.iter().filter(|entry| entry.0 == kind).count();
        assert!(count >= 3, "{kind:?}: {count}");
    }
}

#[test]
fn the_same_seed_gives_the_same_bits() {
    let maze = maze("maze6");
    let grid = || course(&mut GridArena::new(maze.clone()));
    assert_eq!(grid(), grid());
    let robot = || course(&mut robot(&maze, 1.0, true));
    assert_eq!(robot(), robot());
}
