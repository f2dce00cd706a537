//! A world with an `origin` has the same course of events, told in the frame of its map.

use nalgebra::{Isometry2, Matrix3, Vector2};
use serde_json::json;
use xcscr::arena::{
    Arena, BatchArena, GridArena, Localisation, Outcome, PhysicsArena, PhysicsParams, Sample,
};
use xcscr::streams::StreamName;
use xcscr::world::{Cell, Maze};
use xcscr::xcs::Action;
use xcscr::xcs::random::Stream;

/// The pose of the grid in the map: x and y in metres, and the yaw in radians.
const ORIGIN: [f64; 3] = [-12.5, 3.75, 0.6];

fn maze(origin: [f64; 3]) -> Maze {
    let rows = ["######", "#S.#.#", "##...#", "#..#G#", "######"];
    let world = json!({ "name": "placed", "cell_size_m": 0.8, "origin": origin, "rows": rows });
    Maze::from_json(world.to_string().as_bytes(), "placed.json").unwrap()
}

fn grid_in_map() -> Isometry2<f64> {
    let [x_m, y_m, yaw_rad] = ORIGIN;
    Isometry2::new(Vector2::new(x_m, y_m), yaw_rad)
}

/// Random actions; back to the start from the goal.
fn drive(arena: &mut dyn Arena, mut after: impl FnMut(&dyn Arena, Outcome)) {
    let mut stream = Stream::new(5, StreamName::Exploration);
    for _ in 0..200 {
        let outcome = arena.act(Action::new(stream.below(4)).unwrap());
        after(arena, outcome);
        let view = arena.view();
        if view.maze.is_goal(view.cell) {
            let start = view.maze.start().unwrap();
            arena.reset(start);
        }
    }
}

/// Outcomes, poses, and points and directions of hits.
type Course = (Vec<String>, Vec<Isometry2<f64>>, Vec<[Vector2<f64>; 2]>);

fn course(arena: &mut dyn Arena) -> Course {
    let (mut outcomes, mut poses, mut hits) = (Vec::new(), Vec::new(), Vec::new());
    drive(arena, |arena, outcome| {
        let view = arena.view();
        outcomes.push(format!("{outcome:?} {:?}", view.cell));
        poses.extend(view.trace.iter().map(|sample: &Sample| sample.robot_in_map));
        let contacts = view.contacts.iter();
        hits.extend(contacts.map(|hit| [hit.point_in_map.coords, hit.normal_in_map]));
    });
    (outcomes, poses, hits)
}

fn apart(a: &Isometry2<f64>, b: &Isometry2<f64>) -> f64 {
    let shift = (a.translation.vector - b.translation.vector).norm();
    shift + a.rotation.angle_to(&b.rotation).abs()
}

#[test]
fn poses_and_hits_are_those_of_the_grid_turned_and_moved_into_the_map() {
    let params = |localisation| PhysicsParams {
        localisation,
        ..PhysicsParams::default()
    };
    let arena = |origin, is_physics, params| -> Box<dyn Arena> {
        match is_physics {
            true => Box::new(PhysicsArena::new(maze(origin), params, 3).unwrap()),
            false => Box::new(GridArena::new(maze(origin))),
        }
    };
    for localisation in [Localisation::Told, Localisation::Estimated] {
        for is_physics in [false, true] {
            let [plain, placed] = [[0.0; 3], ORIGIN]
                .map(|origin| course(&mut *arena(origin, is_physics, params(localisation))));
            assert_eq!(plain.0, placed.0, "outcomes and cells");
            for (plain, placed) in plain.1.iter().zip(&placed.1) {
                assert!(
                    apart(&(grid_in_map() * plain), placed) < 1e-9,
                    "{plain} {placed}"
                );
                assert!(apart(plain, placed) > 1.0, "control");
            }
            assert_eq!(plain.2.len(), placed.2.len());
            for ([point, normal], [point_in_map, normal_in_map]) in plain.2.iter().zip(&placed.2) {
                let point = grid_in_map() * nalgebra::Point2::from(*point);
                assert!((point.coords - point_in_map).norm() < 1e-9);
                assert!((grid_in_map() * normal - normal_in_map).norm() < 1e-9);
            }
        }
    }
}

#[test]
fn estimates_and_their_covariances_are_in_the_map_frame() {
    let arena = |origin| {
        let params = PhysicsParams {
            localisation: Localisation::Estimated,
            ..PhysicsParams::default()
        };
        PhysicsArena::new(maze(origin), params, 3).unwrap()
    };
    let estimates = |arena: &mut PhysicsArena| {
        let mut estimates = Vec::new();
        drive(arena, |arena, _| {
            let view = arena.view();
            let estimate = *view.sensed.unwrap().estimates.last().unwrap();
            let truth = view.now().robot_in_map;
            estimates.push((
                estimate,
                estimate.error(&truth).0,
                estimate.nees(&truth).unwrap(),
            ));
        });
        estimates
    };
    let [plain, placed] = [[0.0; 3], ORIGIN].map(|origin| estimates(&mut arena(origin)));
    let turn = grid_in_map().rotation.to_rotation_matrix();
    let turn: Matrix3<f64> = turn.into_inner().to_homogeneous();
    for ((plain, error, nees), (placed, error_in_map, nees_in_map)) in plain.iter().zip(&placed) {
        let pose = grid_in_map() * plain.robot_in_map;
        assert!(apart(&pose, &placed.robot_in_map) < 1e-9);
        let covariance = turn * plain.covariance * turn.transpose();
        assert!((covariance - placed.covariance).norm() < 1e-9);
        assert!((error - error_in_map).abs() < 1e-9);
        assert!(
            (nees - nees_in_map).abs() < 1e-6 * nees.max(1.0),
            "{nees} {nees_in_map}"
        );
    }
}

#[test]
fn a_cell_is_found_again_at_its_middle_and_lanes_are_in_the_map_frame() {
    let (plain, placed) = (maze([0.0; 3]), maze(ORIGIN));
    for cell in placed.cells() {
        let middle = placed.centre_m(cell);
        assert_eq!(placed.cell_at(middle), Some(cell));
        let expected = grid_in_map() * plain.centre_m(cell);
        assert!((middle - expected).norm() < 1e-9, "{cell:?}");
    }
    assert_ne!(
        placed.cell_at(plain.centre_m(Cell { col: 1, row: 1 })),
        Some(Cell { col: 1, row: 1 })
    );
    let batch = BatchArena::new(&placed, &PhysicsParams::default(), &[1]).unwrap();
    let start = placed.centre_m(placed.start().unwrap());
    let at = [batch.lanes().x_m[0], batch.lanes().y_m[0]];
    // The engine computes in single precision.
    assert!(
        (start.x - at[0]).hypot(start.y - at[1]) < 1e-6,
        "{at:?} {start}"
    );
    let [cosine, sine] = batch.lanes().headings[0];
    assert!(
        (sine.atan2(cosine) - ORIGIN[2]).abs() < 1e-6,
        "east of the grid"
    );
}
