//! Robots of all profiles in cells of several sizes, as `sensing.rs` tests the default robot.

use crate::kit::tally::Tally;
use crate::kit::trial::maze;
use crate::world::sensing::{MAZES, moves};
use xcscr::arena::{Localisation, PhysicsArena, PhysicsParams};
use xcscr::trial::{RobotProfile, Settings};
use xcscr::world::Maze;

/// The figures of a robot profile.
pub fn profile(robot: &str) -> PhysicsParams {
    let profile = RobotProfile::load(robot).unwrap();
    let settings = profile.settings_over(&Settings::default()).unwrap();
    PhysicsParams {
        localisation: Localisation::Estimated,
        ..settings.physics
    }
}

/// A shipped maze with cells of another size, and a robot that senses.
fn profiled(world: &str, cell_size_m: f64, robot: &str) -> PhysicsArena {
    let size = format!("\"cell_size_m\": {cell_size_m}");
    let text = maze(world).to_json();
    let text = text.replace("\"cell_size_m\": 1.0", &size);
    let maze = Maze::from_json(text.as_bytes(), world).unwrap();
    assert_eq!(maze.cell_size_m(), cell_size_m);
    PhysicsArena::new(maze, profile(robot), 1).unwrap()
}

#[test]
fn every_robot_goes_where_it_is_told_and_tells_walls_from_free_cells_in_cells_of_its_size() {
    const BURGER: &str = "turtlebot3-burger";
    // In the smallest cells the robot has 15 mm to a wall on each side.
    for (robot, cell_size_m, wrong_percepts) in [
        ("default", 1.0, None),
        ("turtlebot3-waffle-pi", 0.75, None),
        ("turtlebot4-lite", 0.6, None),
        (BURGER, 0.24, Some(0.005)),
        (BURGER, 0.25, Some(0.0)),
        (BURGER, 0.3, Some(0.0)),
        (BURGER, 0.5, Some(0.0)),
        (BURGER, 1.0, Some(0.0)),
    ] {
        for world in MAZES {
            let tally = Tally::of(&mut profiled(world, cell_size_m, robot), 1, moves(200));
            let what = format!("{robot} in {world}, cells of {cell_size_m} m: {tally:?}");
            assert_eq!(tally.faults(), 0, "{what}");
            let share = f64::from(tally.wrong_percepts) / f64::from(tally.moves);
            assert!(wrong_percepts.is_none_or(|most| share <= most), "{what}");
        }
    }
}

#[test]
fn the_lidar_tells_free_cells_from_walls_up_to_the_largest_cells_that_it_names() {
    for robot in ["default", "turtlebot3-burger"] {
        let lidar = profile(robot).lidar;
        let wrong_percepts = |cell_size_m: f64| {
            let mut arena = profiled("maze5", cell_size_m, robot);
            Tally::of(&mut arena, 1, moves(200)).wrong_percepts
        };
        assert_eq!(wrong_percepts(lidar.largest_cell_m()), 0, "{robot}");
        let too_large = wrong_percepts(lidar.range_m / 1.5);
        assert!(too_large > 50, "control: {robot}: {too_large}");
    }
}
