//! Drives in a world from a map, whose walls are on no grid.

use nalgebra::Isometry2;

use super::scans::{burger, burger_in};
use super::*;
use crate::kit::flat::Flat;

#[test]
fn it_drives_to_the_goal_among_the_true_walls_of_a_map() {
    let maze = Flat::new().gridded(0.5).maze;
    let mut rig = burger_in(maze, 1, DriveOptions::default());
    let (step, decisions, impulse_n_s) = drive(&mut rig);
    assert_eq!(step.phase, Phase::AtGoal, "{step:?}");
    assert!(rig.robot.is_at_goal());
    assert!(decisions.len() > 8, "control: {}", decisions.len());
    assert_eq!(impulse_n_s, 0.0);
}

/// Adds a disc to a scan, like the legs of a person. `middle` is in the frame of the lidar, in metres.
fn add_disc(scan: &mut Scan, middle: nalgebra::Point2<f64>, radius_m: f64) {
    for number in 0..scan.ranges_m.len() {
        let angle_rad = scan.angle_min_rad + number as f64 * scan.angle_increment_rad;
        let along = nalgebra::Vector2::new(angle_rad.cos(), angle_rad.sin());
        let (near_m, beside_m) = (middle.coords.dot(&along), middle.coords.perp(&along));
        if near_m > 0.0 && beside_m.abs() < radius_m {
            let range_m = near_m - (radius_m * radius_m - beside_m * beside_m).sqrt();
            scan.ranges_m[number] = scan.ranges_m[number].min(range_m);
        }
    }
}

/// Drives in a maze in which something appears in the path once the robot is `driven_m` from the middle
/// of a cell on the way to the next one. Returns the outcome of this move, and the least distance to the
/// middle of the thing.
fn meets(driven_m: f64, beyond_m: f64) -> (Option<Outcome>, f64) {
    let mut rig = burger(1, DriveOptions::default());
    let (mut home, mut thing) = (None::<Isometry2<f64>>, None);
    let mut least_m = f64::INFINITY;
    for _ in 0..1_000 {
        let before = rig.robot.true_pose();
        let step = rig.tick(|readings| {
            let here = before.inverse();
            for scan in &mut readings.scans {
                if let Some(thing) = thing {
                    add_disc(scan, here * thing, 0.1);
                }
            }
        });
        let now = rig.robot.true_pose();
        if step.decision.as_ref().is_some_and(|it| it.number == 2) {
            home = Some(now);
        }
        if let Some(home) = home {
            let way = now.translation.vector - home.translation.vector;
            if thing.is_none() && way.norm() > driven_m {
                let along = way.normalize();
                let at = home.translation.vector + beyond_m * along;
                thing = Some(nalgebra::Point2::from(at));
            }
            if thing.is_some() && step.outcome.is_some() {
                return (step.outcome, least_m);
            }
        }
        if let Some(thing) = thing {
            least_m = least_m.min((now.translation.vector - thing.coords).norm());
        }
    }
    panic!("no second move");
}

#[test]
fn an_obstacle_in_the_second_half_of_a_move_stops_the_robot_and_one_behind_its_end_does_not() {
    let radius_m = 0.105;
    // From the middle of a cell to that of the next one it is a metre.
    let (outcome, least_m) = meets(0.6, 1.0);
    assert!(
        matches!(outcome, Some(Outcome::Collided { .. })),
        "{outcome:?}"
    );
    assert!(least_m > radius_m + 0.1, "touched: {least_m}");
    let (outcome, _) = meets(0.6, 1.0 + radius_m + 0.15);
    assert_eq!(outcome, Some(Outcome::Moved), "behind the end");
}

#[test]
fn a_box_in_the_way_leads_to_another_way() {
    let maze = Flat::new().gridded(0.5).maze;
    let paths = Paths::with_slip(&maze, 0.0);
    let next =
        |cell: &Cell| Action::all(4).find_map(|action| paths.successor(&maze, *cell, action));
    let way = std::iter::successors(maze.start(), next);
    let with_box = way.filter_map(|cell| maze.with_box(cell, 0.3)).next();
    let mut rig = burger_in(
        with_box.expect("a cell for the box"),
        1,
        DriveOptions::default(),
    );
    let (step, decisions, _) = drive(&mut rig);
    assert_eq!(step.phase, Phase::AtGoal, "{step:?}");
    let shortest = std::iter::successors(maze.start(), next).count() - 1;
    assert!(decisions.len() > shortest, "control: the box is in the way");
}
