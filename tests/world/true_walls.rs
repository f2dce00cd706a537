//! A world from a map has the walls of the map: for the lidar, for the bumper and for the engine.

use std::hash::Hasher;

use fnv::FnvHasher;
use nalgebra::{Point2, Vector2};
use xcscr::arena::{Agreement, Arena, Localisation, Outcome, PhysicsArena, PhysicsParams, Robot};
use xcscr::sensor::Sensor;
use xcscr::trial::Plan;
use xcscr::world::{Cell, Direction, Maze, OccupancyMap};
use xcscr::xcs::random::Stream;

use crate::kit::flat::{self, Flat};
use crate::kit::tally::{mean, script};
use crate::world::sensing_robots::profile;

/// A small robot without noise, whose pose is known.
fn burger() -> PhysicsParams {
    PhysicsParams {
        localisation: Localisation::GroundTruth,
        noise: 0.0,
        ..profile("turtlebot3-burger")
    }
}

/// The same cells, with walls that fill them.
fn of_blocks(maze: &Maze) -> Maze {
    let mut world: serde_json::Value = serde_json::from_str(&maze.to_json()).unwrap();
    world.as_object_mut().unwrap().remove("solid");
    Maze::from_json(world.to_string().as_bytes(), "blocks").unwrap()
}

/// The distance to the first solid pixel, in steps of a millimetre.
fn marched_m(from: Point2<f64>, along: Vector2<f64>, most_m: f64) -> f64 {
    let steps = (0..).map(|step| f64::from(step) * 0.001);
    let mut steps = steps.take_while(|&range| range < most_m);
    let is_hit = |&range: &f64| {
        let at = from + range * along;
        flat::is_solid(at.x, at.y)
    };
    steps.find(is_hit).unwrap_or(most_m)
}

/// The share of beams from the middles of all cells that end more than 2 cm beside the true wall.
fn beams_off(maze: &Maze) -> f64 {
    let (mut off, mut count) = (0, 0);
    for cell in maze.free_cells() {
        for beam in 0..16 {
            let angle = f64::from(beam) * std::f64::consts::TAU / 16.0 + 0.01;
            let along = Vector2::new(angle.cos(), angle.sin());
            let from = maze.centre_in_grid(cell);
            let range_m = xcscr_sensing::cast(maze, from.coords, along, 3.5).unwrap_or(3.5);
            let true_m = marched_m(maze.centre_m(cell), maze.vector_in_map(along), 3.5);
            off += u32::from((range_m - true_m).abs() > 0.02);
            count += 1;
        }
    }
    f64::from(off) / f64::from(count)
}

#[test]
fn beams_end_at_the_pixels_of_the_map_and_not_at_the_cells() {
    let maze = Flat::new().gridded(0.5).maze;
    assert!(maze.is_from_map());
    // A step of a millimetre can miss the corner of a pixel.
    let off = beams_off(&maze);
    assert!(off < 0.002, "{off}");
    let blocks = beams_off(&of_blocks(&maze));
    assert!(blocks > 0.5, "control: {blocks}");
}

/// A digest of the trace and the contacts of a script of actions, and the number of contacts.
fn driven(maze: &Maze, shortcut: bool, time_out_s: f64) -> (u64, usize) {
    let params = PhysicsParams {
        shortcut,
        time_out_s,
        noise: 1.0,
        ..burger()
    };
    let mut arena = PhysicsArena::new(maze.clone(), params, 1).unwrap();
    let (mut hash, mut contacts) = (FnvHasher::default(), 0);
    for action in script(1, 400) {
        arena.act(action);
        let view = arena.view();
        contacts += view.contacts.len();
        hash.write(format!("{:?} {:?}", view.trace, view.contacts).as_bytes());
        if view.maze.is_goal(view.cell) {
            arena.reset(maze.start_cells()[0]);
        }
    }
    (hash.finish(), contacts)
}

#[test]
fn the_shortcut_gives_the_same_bits_as_the_engine_among_true_walls() {
    let maze = Flat::new().gridded(0.5).maze;
    for time_out_s in [30.0, 3.0] {
        let [with, without] = [true, false].map(|shortcut| driven(&maze, shortcut, time_out_s));
        assert_eq!(with, without, "time-out {time_out_s}");
        assert!(with.1 > 10, "control: {} contacts", with.1);
    }
}

#[test]
fn the_robot_stops_at_the_pixels_of_the_map() {
    let maze = Flat::new().gridded(0.5).maze;
    let mut arena = PhysicsArena::new(maze.clone(), burger(), 1).unwrap();
    let mut random = Stream::new(1, 1_u64);
    let cells: Vec<_> = maze.free_cells().filter(|&c| !maze.is_goal(c)).collect();
    let mut contacts = 0;
    for action in script(2, 300) {
        arena.reset(cells[random.below(cells.len())]);
        arena.act(action);
        for contact in arena.view().contacts {
            let at = contact.point_in_map + 0.02 * contact.normal_in_map;
            assert!(flat::is_solid(at.x, at.y), "{contact:?}");
            let at = contact.point_in_map - 0.04 * contact.normal_in_map;
            assert!(!flat::is_solid(at.x, at.y), "control: {contact:?}");
            contacts += 1;
        }
    }
    assert!(contacts > 30, "control: {contacts} contacts");
}

#[test]
fn a_robot_with_the_map_knows_its_pose_among_walls_that_are_on_no_grid() {
    let maze = Flat::new().gridded(0.5).maze;
    for (level, mean_m, most_m) in [(1.0, 0.012, 0.08), (2.0, 0.02, 0.15)] {
        let params = PhysicsParams {
            localisation: Localisation::Estimated,
            noise: level,
            ..burger()
        };
        let mut arena = PhysicsArena::new(maze.clone(), params, 1).unwrap();
        let mut errors_m = Vec::new();
        for action in script(3, 150) {
            arena.act(action);
            let view = arena.view();
            let estimate = view.sensed.unwrap().estimates.last().unwrap();
            let off = estimate.robot_in_map.inverse() * view.now().robot_in_map;
            errors_m.push(off.translation.vector.norm());
            if view.maze.is_goal(view.cell) {
                arena.reset(maze.start_cells()[0]);
            }
        }
        let found = [
            mean(&errors_m),
            errors_m.iter().copied().fold(0.0, f64::max),
        ];
        assert!(
            found[0] < mean_m && found[1] < most_m,
            "level {level}: {found:?}"
        );
    }
}

/// The least distance of anything solid from the way between two points, by marching.
fn gap_m(maze: &Maze, ends: [Point2<f64>; 2]) -> f64 {
    let [from, to] = ends.map(|end| maze.point_in_map(end));
    let points = (0..=25).map(|step| from + f64::from(step) / 25.0 * (to - from));
    let gap = |at: Point2<f64>| {
        let turns = (0..72).map(|turn| f64::from(turn) * std::f64::consts::TAU / 72.0);
        let ranges = turns.map(|angle| marched_m(at, Vector2::new(angle.cos(), angle.sin()), 0.2));
        ranges.fold(0.2, f64::min)
    };
    points.map(gap).fold(0.2, f64::min)
}

#[test]
fn a_move_is_open_exactly_if_the_robot_touches_nothing_on_its_way() {
    let needed_m = burger().needed_m();
    let maze = Flat::new().gridded(0.5).maze.for_robot(needed_m).unwrap();
    let (mut open, mut barred) = (0, 0);
    for cell in maze.free_cells().step_by(5) {
        for direction in Direction::CLOCKWISE {
            let next = maze.neighbour(cell, direction).unwrap();
            if maze.is_wall(next) {
                continue;
            }
            let gap_m = gap_m(&maze, [cell, next].map(|cell| maze.centre_in_grid(cell)));
            let is_open = maze.is_open(cell, direction);
            // Rays 5 degrees apart see a corner up to a centimetre farther away.
            let is_sure = !(needed_m - 0.001..needed_m + 0.01).contains(&gap_m);
            assert!(
                !is_sure || is_open == (gap_m > needed_m),
                "{cell:?} {direction:?} {gap_m}"
            );
            *if is_open { &mut open } else { &mut barred } += 1;
        }
    }
    assert!(
        open > 60 && barred > 1,
        "control: {open} open, {barred} barred"
    );
}

#[test]
fn a_smaller_robot_has_more_cells_and_moves_and_a_larger_one_is_refused_with_the_place() {
    let maze = Flat::new().gridded(0.5).maze;
    let cells = |radius_m| {
        maze.for_robot(radius_m)
            .map(|maze| maze.free_cells().count())
    };
    assert!(
        cells(0.1) > cells(0.25),
        "{:?} {:?}",
        cells(0.1),
        cells(0.25)
    );
    assert_eq!(cells(0.25), Some(maze.free_cells().count()));
    let huge = PhysicsParams {
        radius_m: 0.6,
        ..burger()
    };
    let refused = PhysicsArena::new(maze, huge, 1).err().unwrap().to_string();
    for part in ["0.615 m on each side", "m wide at"] {
        assert!(refused.contains(part), "{refused}");
    }
}

#[test]
fn a_robot_perceives_the_open_moves_of_every_cell() {
    for cell_m in [0.25, 0.5] {
        let maze = Flat::new().gridded(cell_m).maze;
        let params = profile("turtlebot3-burger");
        let found = Agreement::measure(&maze, &params, Sensor::LidarPosition).unwrap();
        let Agreement {
            places,
            wrong_percepts,
            beams,
            beams_off,
        } = found;
        assert!(places > 50 && beams > 5_000, "{found:?}");
        assert_eq!(wrong_percepts, 0, "{found:?}");
        // A beam along an edge may pass it.
        assert!(f64::from(beams_off) < 1e-3 * f64::from(beams), "{found:?}");
    }
}

#[test]
fn a_noisy_robot_does_as_the_open_moves_say_and_perceives_them() {
    let maze = Flat::new().gridded(0.5).maze;
    let params = PhysicsParams {
        localisation: Localisation::Estimated,
        ..profile("turtlebot3-burger")
    };
    let maze = maze.for_robot(params.needed_m()).unwrap();
    let mut arena = PhysicsArena::new(maze.clone(), params, 1).unwrap();
    let (mut wrong, mut other, mut moves) = (0, 0, 0);
    for action in script(5, 300) {
        let cell = arena.view().cell;
        let expected = maze.step(cell, maze.direction(action).unwrap());
        let outcome = arena.act(action);
        let view = arena.view();
        let is_as_expected = match expected {
            Some(next) => view.cell == next && !matches!(outcome, Outcome::Collided { .. }),
            None => view.cell == cell,
        };
        moves += 1;
        other += u32::from(!is_as_expected);
        let perceived = Sensor::Lidar.perceive(&view);
        wrong += u32::from(perceived != Sensor::Lidar.perceive_at(&maze, view.cell));
        if maze.is_goal(view.cell) {
            arena.reset(maze.start_cells()[0]);
        }
    }
    assert!(
        wrong <= 3 && other <= 3,
        "{wrong} wrong, {other} others of {moves}"
    );
}

#[test]
fn the_main_direction_of_the_walls_is_found_and_the_grid_follows_it() {
    let flat = Flat::new();
    let map = OccupancyMap::load(&flat.yaml()).unwrap();
    let found_rad = map.wall_direction_rad();
    assert!((found_rad - flat::TILT_RAD).abs() < 0.01, "{found_rad}");
    let [straight, turned] = [0.0, found_rad].map(|yaw_rad| flat.turned(0.5, yaw_rad).maze);
    let cells = |maze: &Maze| maze.free_cells().count();
    assert!(
        cells(&turned) > cells(&straight),
        "along the walls more cells fit"
    );
    assert!((turned.origin().yaw_rad - found_rad).abs() < 1e-12);
    assert!(beams_off(&turned) < 0.01, "{}", beams_off(&turned));
    let found = Agreement::measure(&turned, &profile("turtlebot3-burger"), Sensor::Lidar).unwrap();
    assert_eq!(found.wrong_percepts, 0, "{found:?}");
    assert!(
        f64::from(found.beams_off) < 0.01 * f64::from(found.beams),
        "{found:?}"
    );
}

/// The map of a world from a map, in a folder.
fn written(maze: &Maze, edit: impl Fn(&mut Vec<u8>)) -> Result<Maze, String> {
    let map = super::maps::Map(tempfile::tempdir().unwrap());
    let mut files = maze.to_map("map.pgm");
    edit(&mut files.image);
    map.keep("map.yaml", files.yaml.as_bytes());
    map.keep("map.pgm", &files.image);
    let gridded = super::maps::plain().of(&map.load().unwrap());
    gridded
        .map(|gridded| gridded.maze)
        .map_err(|fault| fault.to_string())
}

#[test]
fn a_world_from_a_map_is_written_with_its_pixels_and_read_back() {
    let maze = Flat::new().turned(0.5, flat::TILT_RAD).maze;
    assert_eq!(written(&maze, |_| ()).unwrap(), maze);
    let files = maze.to_map("map.pgm");
    let map = super::maps::Map(tempfile::tempdir().unwrap());
    map.keep("map.yaml", files.yaml.as_bytes());
    map.keep("map.pgm", &files.image);
    let map = map.load().unwrap();
    let mut solid = 0;
    for (col, row) in (0..map.height).flat_map(|row| (0..map.width).map(move |col| (col, row))) {
        let middle =
            [col as f64 + 0.5, (map.height - row) as f64 - 0.5].map(|at| at * map.resolution_m);
        let at = map.origin.to_map(middle.into());
        let is_solid = flat::is_solid(at.x, at.y);
        assert_eq!(map.value(col, row) == 100, is_solid, "{at}");
        solid += u32::from(is_solid);
    }
    assert!(solid > 100, "control: {solid}");
}

#[test]
fn an_edited_image_of_a_world_from_a_map_changes_its_walls() {
    let maze = Flat::new().gridded(0.5).maze;
    let [width, height] = maze.solid().size();
    let paint = |image: &mut Vec<u8>, rows: std::ops::Range<usize>, grey: u8| {
        let first = image.len() - width * height;
        image[first + rows.start * width..first + rows.end * width].fill(grey);
    };
    let last = maze.start().unwrap();
    let narrower = written(&maze, |image| paint(image, 0..8, 0)).unwrap();
    assert!(narrower.free_cells().count() < maze.free_cells().count());
    assert_eq!(
        (narrower.start(), narrower.goals()),
        (Some(last), maze.goals())
    );
    let closed = written(&maze, |image| paint(image, 0..height, 0));
    assert!(
        closed
            .unwrap_err()
            .contains("no path in the grid leads to the goal")
    );
}

#[test]
fn a_plan_and_its_robot_find_the_same_cells_whatever_the_size_of_the_robot() {
    let maze = Flat::new().gridded(0.5).maze;
    let free = |maze: &Maze| maze.free_cells().collect::<Vec<Cell>>();
    let counts = [0.08, 0.15, 0.25].map(|radius_m| {
        let mut plan = Plan::new(maze.clone());
        plan.config.settings.physics.radius_m = radius_m;
        let physics = plan.config.settings.physics.clone();
        let robot = Robot::new(maze.clone(), physics, 1).unwrap();
        let cells = free(&plan.settled().maze);
        assert_eq!(free(robot.maze()), cells, "{radius_m}");
        cells.len()
    });
    assert!(counts[0] > counts[2], "control: {counts:?}");
}
