//! A world with an `origin` has the same course of events, told in the frame of its map.

use nalgebra::{Isometry2, Matrix3, Point2, Vector2};
use serde_json::json;
use xcscr::arena::PhysicsParams;
use xcscr::arena::{Arena, Estimate, GridArena, Localisation, PhysicsArena};
use xcscr::world::{Cell, Maze};

use crate::kit::tally::script;
use crate::world::worlds::drawn;

/// The pose of the grid in the map: x and y in metres, and the yaw in radians.
const ORIGIN: [f64; 3] = [-12.5, 3.75, 0.6];

fn maze(origin: [f64; 3]) -> Maze {
    let rows = ["######", "#S.#.#", "##...#", "#..#G#", "######"];
    drawn(json!({ "cell_size_m": 0.8, "origin": origin }), &rows)
}

fn grid_in_map() -> Isometry2<f64> {
    let [x_m, y_m, yaw_rad] = ORIGIN;
    Isometry2::new(Vector2::new(x_m, y_m), yaw_rad)
}

/// What happens in a maze.
#[derive(Default)]
struct Course {
    outcomes: Vec<String>,
    poses: Vec<Isometry2<f64>>,
    /// The points and directions of hits.
    hits: Vec<[Vector2<f64>; 2]>,
    /// The last estimate of each action, its error in metres, and its normalised error.
    estimates: Vec<(Estimate, f64, f64)>,
}

/// Random actions; back to the start from the goal.
fn course(arena: &mut dyn Arena) -> Course {
    let mut course = Course::default();
    for action in script(5, 200) {
        let outcome = arena.act(action);
        let view = arena.view();
        course.outcomes.push(format!("{outcome:?} {:?}", view.cell));
        let poses = view.trace.iter().map(|sample| sample.robot_in_map);
        course.poses.extend(poses);
        let contacts = view.contacts.iter();
        let hits = contacts.map(|hit| [hit.point_in_map.coords, hit.normal_in_map]);
        course.hits.extend(hits);
        if let Some(estimate) = view.sensed.and_then(|sensed| sensed.estimates.last()) {
            let truth = view.now().robot_in_map;
            let nees = estimate.nees(&truth).unwrap();
            let error_m = estimate.error(&truth).0;
            course.estimates.push((*estimate, error_m, nees));
        }
        if view.maze.is_goal(view.cell) {
            let start = view.maze.start().unwrap();
            arena.reset(start);
        }
    }
    course
}

fn apart(a: &Isometry2<f64>, b: &Isometry2<f64>) -> f64 {
    let shift = (a.translation.vector - b.translation.vector).norm();
    shift + a.rotation.angle_to(&b.rotation).abs()
}

#[test]
fn poses_hits_and_estimates_are_those_of_the_grid_turned_and_moved_into_the_map() {
    let turn = grid_in_map().rotation.to_rotation_matrix();
    let turn: Matrix3<f64> = turn.into_inner().to_homogeneous();
    for localisation in [
        None,
        Some(Localisation::GroundTruth),
        Some(Localisation::Estimated),
    ] {
        let [plain, placed] = [[0.0; 3], ORIGIN].map(|origin| {
            let Some(localisation) = localisation else {
                return course(&mut GridArena::new(maze(origin)));
            };
            let params = PhysicsParams {
                localisation,
                ..PhysicsParams::default()
            };
            course(&mut PhysicsArena::new(maze(origin), params, 3).unwrap())
        });
        assert_eq!(plain.outcomes, placed.outcomes, "outcomes and cells");
        for (plain, placed) in plain.poses.iter().zip(&placed.poses) {
            let off = apart(&(grid_in_map() * plain), placed);
            assert!(off < 1e-9, "{plain} {placed}");
            assert!(apart(plain, placed) > 1.0, "control");
        }
        assert_eq!(plain.hits.len(), placed.hits.len());
        for ([point, normal], [point_in_map, normal_in_map]) in plain.hits.iter().zip(&placed.hits)
        {
            let point = grid_in_map() * Point2::from(*point);
            assert!((point.coords - point_in_map).norm() < 1e-9);
            assert!((grid_in_map() * normal - normal_in_map).norm() < 1e-9);
        }
        let is_estimated = localisation == Some(Localisation::Estimated);
        assert_eq!(plain.estimates.len(), if is_estimated { 200 } else { 0 });
        for ((plain, error_m, nees), (placed, error_in_map_m, nees_in_map)) in
            plain.estimates.iter().zip(&placed.estimates)
        {
            let pose = grid_in_map() * plain.robot_in_map;
            assert!(apart(&pose, &placed.robot_in_map) < 1e-9);
            let covariance = turn * plain.covariance * turn.transpose();
            assert!((covariance - placed.covariance).norm() < 1e-9);
            assert!((error_m - error_in_map_m).abs() < 1e-9);
            let off = (nees - nees_in_map).abs();
            assert!(off < 1e-6 * nees.max(1.0), "{nees} {nees_in_map}");
        }
    }
}

#[test]
fn a_cell_is_found_again_at_its_middle_and_the_pose_is_in_the_map_frame() {
    let (plain, placed) = (maze([0.0; 3]), maze(ORIGIN));
    for cell in placed.cells() {
        let middle = placed.centre_m(cell);
        assert_eq!(placed.cell_at(middle), Some(cell));
        let expected = grid_in_map() * plain.centre_m(cell);
        assert!((middle - expected).norm() < 1e-9, "{cell:?}");
    }
    let first = Cell { col: 1, row: 1 };
    assert_ne!(placed.cell_at(plain.centre_m(first)), Some(first));
    let arena = PhysicsArena::new(placed.clone(), PhysicsParams::default(), 1).unwrap();
    let pose = arena.view().now().robot_in_map;
    let start = placed.centre_m(placed.start().unwrap());
    // The engine computes in single precision.
    let off_m = (start.coords - pose.translation.vector).norm();
    assert!(off_m < 1e-6, "{pose} {start}");
    let off_rad = pose.rotation.angle() - ORIGIN[2];
    assert!(off_rad.abs() < 1e-6, "east of the grid");
}
