//! Settings with a unit mean that unit, whatever the size of a cell.
//!
//! One robot drives through the same hall (8 m x 2 m), drawn with cells of four sizes.

use serde_json::json;
use xcscr::arena::{
    Arena, LidarParams, Localisation, Outcome, PhysicsArena, PhysicsError, PhysicsParams,
};
use xcscr::world::Maze;
use xcscr::xcs::Action;

use crate::kit::tally;
use crate::world::worlds::drawn;

const SIZES_M: [f64; 4] = [0.25, 0.5, 1.0, 2.0];
const LENGTH_M: f64 = 8.0;
const WIDTH_M: f64 = 2.0;
const EAST: usize = 1;
const NORTH: usize = 0;

/// The hall with a border of one cell. The goal is the north-eastern cell, the start the south-western one.
fn hall(cell_size_m: f64) -> Maze {
    let [columns, rows] = [LENGTH_M, WIDTH_M].map(|length_m| (length_m / cell_size_m) as usize);
    let border = "#".repeat(columns + 2);
    let mut inside = vec![format!("#{}#", ".".repeat(columns)); rows];
    inside[0].replace_range(columns..=columns, "G");
    inside[rows - 1].replace_range(1..2, "S");
    let rows = [vec![border.clone()], inside, vec![border]].concat();
    drawn(json!({ "cell_size_m": cell_size_m }), &rows)
}

/// A small slow robot with a lidar whose only faults are range noise, scale and offset.
fn small_robot() -> PhysicsParams {
    PhysicsParams {
        radius_m: 0.08,
        wheel_base_m: 0.12,
        max_speed_mps: 0.3,
        max_turn_radps: 2.0,
        arrival_m: 0.02,
        arrival_mps: 0.1,
        time_out_s: 20.0,
        localisation: Localisation::Estimated,
        lidar: LidarParams {
            range_m: 4.0,
            jitter_rad: 0.0,
            dropouts: 0.0,
            outliers: 0.0,
            ..LidarParams::default()
        },
        ..PhysicsParams::default()
    }
}

fn arena(cell_size_m: f64) -> PhysicsArena {
    PhysicsArena::new(hall(cell_size_m), small_robot(), 1).unwrap()
}

/// How far both wheels rolled in the mean, how far the body moved, and how far the wheels turned it, in metres
/// and radians a second, at most in a step of the last action.
fn fastest_step(robot: &PhysicsArena) -> [f64; 3] {
    let mut top = [0.0_f64; 3];
    for pair in robot.view().trace.windows(2) {
        let [left, right] =
            [0, 1].map(|side| pair[1].wheel_travel_m[side] - pair[0].wheel_travel_m[side]);
        let [a, b] = [&pair[0], &pair[1]].map(|sample| sample.robot_in_map.translation.vector);
        let turned_rad = (right - left).abs() / small_robot().wheel_base_m;
        let steps = [(left + right).abs() / 2.0, (b - a).norm(), turned_rad];
        for (top, step) in top.iter_mut().zip(steps) {
            *top = top.max(step / 0.05);
        }
    }
    top
}

/// The highest speed of the wheels and of the body on the way east, in m/s.
fn top_speeds_mps(robot: &mut PhysicsArena) -> [f64; 2] {
    let mut top = [0.0_f64; 2];
    while robot.view().now().robot_in_map.translation.x < LENGTH_M / 2.0 {
        let outcome = robot.act(Action::new(EAST).unwrap());
        assert!(matches!(outcome, Outcome::Moved), "{outcome:?}");
        let [wheels, body, _] = fastest_step(robot);
        top = [top[0].max(wheels), top[1].max(body)];
    }
    top
}

/// The distance in metres from a point (metres from the hall's south-western corner) to the hall's walls,
/// along a unit vector.
fn distance_m([x, y]: [f64; 2], [east, north]: [f64; 2]) -> f64 {
    let along = |at: f64, way: f64, length_m: f64| match way {
        way if way > 0.0 => (length_m - at) / way,
        way if way < 0.0 => -at / way,
        _ => f64::INFINITY,
    };
    along(x, east, LENGTH_M).min(along(y, north, WIDTH_M))
}

/// The mean and the deviation of what the lidar of a robot at rest measures too much, in metres, in
/// directions in which the wall is about 1.9 m away; and the longest range.
fn lidar_errors(robot: &mut PhysicsArena, cell_size_m: f64) -> ([f64; 2], f64) {
    let (mut errors, mut longest) = (Vec::new(), 0.0_f64);
    let start = robot.view().maze.start().unwrap();
    for _ in 0..150 {
        robot.reset(start);
        let view = robot.view();
        let at = view.now().robot_in_map.translation;
        let at = [at.x - cell_size_m, at.y - cell_size_m];
        for beam in view.sensed.unwrap().beams {
            let truth_m = distance_m(at, [beam.bearing.re, beam.bearing.im]);
            let Some(range_m) = beam.range_m else {
                let is_out_of_range = !(0.16..3.8).contains(&truth_m);
                assert!(is_out_of_range, "nothing came back from {truth_m} m");
                continue;
            };
            longest = longest.max(range_m);
            if (1.7..2.1).contains(&truth_m) {
                errors.push(range_m - truth_m);
            }
        }
    }
    let mean = tally::mean(&errors);
    let squares: Vec<f64> = errors.iter().map(|error| (error - mean).powi(2)).collect();
    ([mean, tally::mean(&squares).sqrt()], longest)
}

#[test]
fn one_robot_has_the_same_speeds_and_estimates_its_pose_as_well_in_cells_of_every_size() {
    for size_m in SIZES_M {
        let mut robot = arena(size_m);
        let what = format!("cells of {size_m} m");
        // It turns to the wall or the cells on its left.
        robot.act(Action::new(NORTH).unwrap());
        let [.., turn] = fastest_step(&robot);
        let most = small_robot().max_turn_radps;
        let is_quick = (0.9 * most..=1.01 * most).contains(&turn);
        assert!(is_quick, "{what}: {turn} rad/s, {most} at most");
        let [wheels, body] = top_speeds_mps(&mut robot);
        // The body differs from the wheels by the noise of the wheels: 5 % for an action, 5 % for a step.
        assert!((0.297..=0.302).contains(&wheels), "{what}: {wheels} m/s");
        assert!((0.27..=0.38).contains(&body), "{what}: {body} m/s");
        let view = robot.view();
        let estimate = view.sensed.unwrap().estimates.last().unwrap();
        let (error_m, _) = estimate.error(&view.now().robot_in_map);
        assert!(error_m < 0.06, "{what}: {error_m} m off");
    }
}

#[test]
fn one_lidar_has_the_same_range_and_the_same_noise_in_cells_of_every_size() {
    for size_m in SIZES_M {
        let ([mean, deviation], longest) = lidar_errors(&mut arena(size_m), size_m);
        let what = format!("cells of {size_m} m: {mean} {deviation} {longest} m");
        // 5 mm and 1 % of the range are 24 mm at 1.9 m.
        assert!((0.0215..0.0265).contains(&deviation), "{what}");
        // Scale and offset of this robot's lidar, drawn from its seed.
        assert!(mean.abs() < 0.05, "{what}");
        assert!((2.5..=4.0).contains(&longest), "{what}");
    }
}

#[test]
fn a_world_wider_than_single_precision_allows_is_refused() {
    let refused = |cells: usize| {
        let (wall, free) = ("#".repeat(cells), ".".repeat(cells - 4));
        let rows = [&wall, &format!("#S{free}G#"), &wall];
        let maze = drawn(json!({ "cell_size_m": 8.0 }), &rows);
        PhysicsArena::new(maze, PhysicsParams::default(), 1).err()
    };
    let found = refused(513);
    assert!(
        matches!(found, Some(PhysicsError::TooWide { .. })),
        "{found:?}"
    );
    assert!(refused(512).is_none(), "control");
}
