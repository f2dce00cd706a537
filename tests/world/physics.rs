//! What the simulated robot does: it drives where it is told to, knows when it hits a wall, and
//! does the same again, to the bit. And what every arena promises, checked on the grid and in physics.

use std::hash::Hasher;

use fnv::FnvHasher;
use nalgebra::{Point2, Vector2};
use serde_json::json;
use xcscr::arena::PhysicsParams;
use xcscr::arena::{Arena, GridArena, Localisation, Outcome, PhysicsArena};
use xcscr::sensor::Sensor;
use xcscr::streams::StreamName;
use xcscr::world::{Cell, Maze};
use xcscr::xcs::Action;
use xcscr::xcs::random::Stream;

use crate::kit::chance::rounds;
use crate::kit::tally::script;
use crate::kit::trial::maze;
use crate::world::worlds::drawn;

const MAZES: [&str; 3] = ["maze4", "maze5", "maze6"];
const EAST: usize = 1;

fn arena(maze: Maze, params: &PhysicsParams, seed: u64) -> PhysicsArena {
    PhysicsArena::new(maze, params.clone(), seed).unwrap()
}

fn noise(noise: f64) -> PhysicsParams {
    PhysicsParams {
        noise,
        ..PhysicsParams::default()
    }
}

/// A robot that knows only what it senses.
fn senses(level: f64) -> PhysicsParams {
    PhysicsParams {
        localisation: Localisation::Estimated,
        ..noise(level)
    }
}

/// Actions that end after half a second, wherever the robot is by then: often against a wall.
fn hurried(noise: f64) -> PhysicsParams {
    PhysicsParams {
        noise,
        time_out_s: 0.5,
        ..PhysicsParams::default()
    }
}

/// Puts the robot back to the first start once it is in a goal.
fn restart_in_goal(arena: &mut PhysicsArena) {
    let view = arena.view();
    if view.maze.is_goal(view.cell) {
        let start = view.maze.start_cells()[0];
        arena.reset(start);
    }
}

/// All bits that can be seen of the last action, added to a digest (FNV-1a).
fn add_to_digest(arena: &PhysicsArena, hash: &mut FnvHasher) {
    let mut mix = |time_ns: u64, numbers: &[f64]| {
        hash.write(&time_ns.to_le_bytes());
        for number in numbers {
            hash.write(&number.to_bits().to_le_bytes());
        }
    };
    let view = arena.view();
    for sample in view.trace {
        let pose = sample.robot_in_map;
        let (at, turn) = (pose.translation, pose.rotation);
        let [left, right] = sample.wheel_travel_m;
        mix(sample.time_ns, &[at.x, at.y, turn.re, turn.im, left, right]);
    }
    for hit in view.contacts {
        let (point, normal) = (hit.point_in_map, hit.normal_in_map);
        let numbers = [point.x, point.y, normal.x, normal.y, hit.impulse_n_s];
        mix(hit.time_ns, &numbers);
    }
    if let Some(sensed) = view.sensed {
        let seen = Sensor::Lidar.perceive(&view);
        let text = format!("{:?} {:?} {seen:?}", sensed.estimates, sensed.beams);
        hash.write(text.as_bytes());
    }
}

/// The digest of a whole script of actions.
fn digest_of(mut arena: PhysicsArena, actions: impl Iterator<Item = Action>) -> u64 {
    let mut hash = FnvHasher::default();
    for action in actions {
        arena.act(action);
        add_to_digest(&arena, &mut hash);
        restart_in_goal(&mut arena);
    }
    hash.finish()
}

/// What an arena did.
#[derive(Debug, Default)]
struct Course {
    /// The outcome of each action without the numbers that only some arenas have, and the cell.
    facts: Vec<(String, Cell)>,
    physics_steps: usize,
    /// How far from the middle of a cell the robot ended.
    largest_offset_in_cells: f64,
}

/// Random actions in episodes from random free cells, each ended by the goal or after forty actions, and the
/// promises kept in each.
fn course(arena: &mut dyn Arena, actions: usize) -> Course {
    let mut random = Stream::new(1, StreamName::Exploration);
    let maze = arena.view().maze.clone();
    let starts: Vec<Cell> = maze.free_cells().filter(|&c| !maze.is_goal(c)).collect();
    let (mut course, mut left) = (Course::default(), 0);
    for step in 0..actions {
        if left == 0 {
            let clock_ns = arena.view().now().time_ns;
            let start = starts[random.below(starts.len())];
            arena.reset(start);
            check_reset(arena, start, clock_ns);
            left = 40;
        }
        let action = Action::new(random.below(4)).unwrap();
        let (from, clock_ns) = (arena.view().cell, arena.view().now().time_ns);
        let outcome = arena.act(action);
        let view = arena.view();
        check_step(
            arena,
            outcome,
            from,
            clock_ns,
            &format!("step {step}, {action:?}"),
        );
        let kind = format!("{outcome:?}").split(' ').next().unwrap().to_owned();
        course.facts.push((kind, view.cell));
        course.physics_steps += view.trace.len() - 1;
        let at: Point2<f64> = view.now().robot_in_map.translation.vector.into();
        let offset = (maze.centre_m(view.cell) - at).norm() / maze.cell_size_m();
        course.largest_offset_in_cells = course.largest_offset_in_cells.max(offset);
        left = if outcome == Outcome::ReachedGoal {
            0
        } else {
            left - 1
        };
    }
    course
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
fn check_step(arena: &dyn Arena, outcome: Outcome, from: Cell, clock_ns: u64, step: &str) {
    let view = arena.view();
    let is_goal = view.maze.is_goal(view.cell);
    let is_kept = match outcome {
        Outcome::Moved => view.cell != from && !is_goal,
        Outcome::Collided { impulse_n_s } => {
            view.cell == from
                && impulse_n_s.is_none_or(|impulse| impulse > 0.0)
                && impulse_n_s.is_some() != view.contacts.is_empty()
        }
        Outcome::ReachedGoal => is_goal,
        // No time is short here.
        Outcome::Stalled => false,
    };
    assert!(is_kept, "{step} from {from:?}: {outcome:?}");
    assert_eq!(view.trace[0].time_ns, clock_ns, "{step}");
    let ordered = view.trace.is_sorted_by(|a, b| a.time_ns < b.time_ns);
    assert!(ordered && view.trace.len() > 1, "{step}");
}

#[test]
fn noisy_moves_end_where_those_on_the_grid_do() {
    for (world, level, shortcut, moves) in [
        ("maze4", 1.0, true, [3_000, 10_000]),
        ("maze5", 1.0, true, [3_000, 10_000]),
        ("maze6", 1.0, true, [3_000, 10_000]),
        ("maze4", 0.0, true, [1_000, 1_000]),
        ("maze6", 0.0, false, [1_000, 1_000]),
        ("maze5", 3.0, true, [3_000, 3_000]),
    ] {
        let moves = rounds([moves[0], moves[1], moves[1]]);
        let params = PhysicsParams {
            shortcut,
            ..noise(level)
        };
        let grid = course(&mut GridArena::new(maze(world)), moves);
        let robot = course(&mut arena(maze(world), &params, 1), moves);
        let what = format!("{world}, noise {level}, shortcut {shortcut}");
        let parted = grid.facts.iter().zip(&robot.facts).find(|(a, b)| a != b);
        assert_eq!(parted, None, "{what}");
        let offset = robot.largest_offset_in_cells;
        assert!(offset < 0.2 || level > 1.0, "{what}: {offset}");
        for kind in ["Moved", "Collided", "ReachedGoal"] {
            let count = grid.facts.iter().filter(|fact| fact.0 == kind).count();
            assert!(count >= 3, "control: {kind}: {count}");
        }
    }
}

#[test]
fn three_times_the_noise_is_seen() {
    let [usual, rough] =
        [1.0, 3.0].map(|level| course(&mut arena(maze("maze5"), &noise(level), 2), 3_000));
    let steps = [usual.physics_steps, rough.physics_steps];
    assert!(steps[1] > steps[0], "{steps:?}");
}

#[test]
fn a_wall_stops_the_robot_and_without_one_it_passes() {
    let east = Action::new(EAST).unwrap();
    let mut robot = arena(
        drawn(json!({}), &["####", "#S##", "#.G#", "####"]),
        &noise(0.0),
        1,
    );
    let start = robot.view().cell;
    let outcome = robot.act(east);
    let view = robot.view();
    assert!(matches!(outcome, Outcome::Collided { .. }), "{outcome:?}");
    assert_eq!((view.cell, view.contacts.len()), (start, 1));
    let furthest = view.trace.iter().map(|s| s.robot_in_map.translation.x);
    let furthest = furthest.fold(0.0, f64::max);
    // The wall begins at x = 2, the robot has a radius of 0.3.
    assert!((1.69..1.72).contains(&furthest), "{furthest}");
    let contact = view.contacts[0];
    assert!((contact.point_in_map.x - 2.0).abs() < 0.02, "{contact:?}");
    assert_eq!(contact.normal_in_map, Vector2::x());
    let mut robot = arena(
        drawn(json!({}), &["#####", "#S.G#", "#####"]),
        &noise(0.0),
        1,
    );
    assert_eq!(robot.act(east), Outcome::Moved);
    assert_eq!(robot.act(east), Outcome::ReachedGoal);
    assert_eq!(robot.view().cell, robot.view().maze.goals()[0]);
    assert!(robot.view().contacts.is_empty());
}

/// The momentum that a frontal hit takes away is the impulse that is reported.
#[test]
fn the_impulse_of_a_hit_is_mass_times_speed() {
    let mass_kg = PhysicsParams::default().mass_kg;
    let mut robot = arena(maze("maze6"), &noise(1.0), 4);
    let mut ratios: Vec<f64> = Vec::new();
    for action in script(4, 2_000) {
        if let Outcome::Collided { impulse_n_s } = robot.act(action) {
            let trace = robot.view().trace;
            let hit_ns = robot.view().contacts[0].time_ns;
            let hit = trace.iter().position(|s| s.time_ns == hit_ns).unwrap();
            let rolled = |i: usize| trace[i].wheel_travel_m.iter().sum::<f64>() / 2.0;
            let speed_mps = (rolled(hit) - rolled(hit - 1)).abs() / 0.05;
            ratios.push(impulse_n_s.unwrap() / (mass_kg * speed_mps));
        }
        restart_in_goal(&mut robot);
    }
    // The single hit differs by the noise of the wheels, whose speed stands for the robot's.
    let mean = crate::kit::tally::mean(&ratios);
    let hits = ratios.len();
    assert!(hits > 500 && (0.95..1.05).contains(&mean), "{hits} {mean}");
    assert!(
        ratios.iter().all(|ratio| (0.8..1.2).contains(ratio)),
        "{ratios:?}"
    );
}

#[test]
fn the_shortcut_gives_the_same_bits_as_the_engine() {
    for (seed, (world, params, actions)) in (1..).zip([
        ("maze4", noise(1.0), 1_500),
        ("maze4", noise(3.0), 1_500),
        ("maze4", hurried(1.0), 1_500),
        ("maze4", hurried(5.0), 1_500),
        // Some of the floor is slippery there.
        ("maze5-wet", senses(1.0), 200),
    ]) {
        let [with, without] = [true, false].map(|shortcut| {
            let params = PhysicsParams {
                shortcut,
                ..params.clone()
            };
            digest_of(arena(maze(world), &params, seed), script(seed, actions))
        });
        assert_eq!(with, without, "seed {seed}, {params:?}");
    }
}

#[test]
fn noise_changes_the_path_and_without_noise_the_seed_does_not_matter() {
    let digest = |level, seed| digest_of(arena(maze("maze4"), &noise(level), seed), script(1, 50));
    assert_eq!(digest(1.0, 1), digest(1.0, 1));
    assert_ne!(digest(1.0, 1), digest(1.0, 2));
    assert_ne!(digest(1.0, 1), digest(2.0, 1));
    assert_eq!(digest(0.0, 1), digest(0.0, 2));
}

/// The bits of 300 moves in each maze, seed 1, noise as usual.
///
/// They are the same in every build and on every machine. A change here means that recordings of
/// earlier versions replay otherwise, and that published figures of the physics arena no longer
/// come out: it belongs in the changelog, and is right only if the change was wanted.
#[test]
fn the_bits_are_those_of_earlier_versions() {
    const GOLDEN: [u64; 3] = [
        0x117a_260d_e23e_4051,
        0x1db9_a911_69c5_6076,
        0xf550_39c0_821a_a591,
    ];
    let digests = MAZES.map(|world| digest_of(arena(maze(world), &noise(1.0), 1), script(1, 300)));
    assert_eq!(digests, GOLDEN, "{digests:#018x?}");
}
