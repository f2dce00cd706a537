//! Compares a learned policy with a planner on the same map: the same simulated robot, sensors and
//! localisation. The planner is A* on the pixels of the map, and pure pursuit follows its path. Both
//! know the map; only the policy was learned.
//!
//! ```sh
//! cargo run --example draw_office_map -- office
//! cargo run -- world convert office/office.yaml --cell 0.5 --start 2.0,2.0 --goal 14.0,12.5 -o office.json
//! cargo run -- train office.json --robot turtlebot3-burger --out office-run
//! cargo run --example compare_with_planner -- office-run 20 101
//! ```

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};
use std::error::Error;
use std::path::Path;

use nalgebra::{Isometry2, Isometry3, Point2};
use xcscr::arena::Speeds;
use xcscr::drive::*;
use xcscr::run::RunFolder;
use xcscr::world::Maze;

const STEP_NS: u64 = 50_000_000;
/// The longest drive in steps of 50 ms: 20 minutes.
const MOST_STEPS: u64 = 24_000;
/// The free width beside the robot on a planned path, in metres.
const MARGIN_M: f64 = 0.05;
/// The distance of the point on the path that the robot drives to.
const LOOKAHEAD_M: f64 = 0.3;
/// The distance from the goal at which the planner's robot has arrived.
const ARRIVED_M: f64 = 0.1;

/// Column and row of a pixel.
type Pixel = [i32; 2];

/// Returns the shortest path between two points of the grid frame, pixel by pixel.
fn planned(maze: &Maze, [from, to]: [Point2<f64>; 2], radius_m: f64) -> Option<Vec<Point2<f64>>> {
    let solid = maze.solid();
    let corner = solid.corner_in_grid().copied().unwrap_or_default();
    let pixel_of = |point: Point2<f64>| {
        let at = corner.inverse_transform_point(&point) / solid.pixel_m();
        [at.x.floor() as i32, at.y.floor() as i32]
    };
    let [start, goal] = [from, to].map(pixel_of);
    let length = |[x, y]: Pixel, [col, row]: Pixel| f64::from(x - col).hypot(f64::from(y - row));
    // Costs are counted in thousandths of a pixel.
    let cost = |pixels: f64| (1000.0 * pixels) as u64;
    let mut best: BTreeMap<Pixel, (u64, Pixel)> = BTreeMap::from([(start, (0, start))]);
    let mut open = BinaryHeap::from([Reverse((cost(length(start, goal)), start))]);
    while let Some(Reverse((_, here))) = open.pop().filter(|Reverse((_, here))| *here != goal) {
        for (x, y) in [
            (-1, -1),
            (-1, 0),
            (-1, 1),
            (0, -1),
            (0, 1),
            (1, -1),
            (1, 0),
            (1, 1),
        ] {
            let next = [here[0] + x, here[1] + y];
            let so_far = best[&here].0 + cost(length(here, next));
            let is_better = best.get(&next).is_none_or(|(other, _)| so_far < *other);
            if is_better && solid.clear_m(next[0], next[1]) >= radius_m {
                best.insert(next, (so_far, here));
                open.push(Reverse((so_far + cost(length(next, goal)), next)));
            }
        }
    }
    let mut path = vec![*best.contains_key(&goal).then_some(&goal)?];
    while *path.last()? != start {
        path.push(best[path.last()?].1);
    }
    let middle = |[col, row]: &Pixel| {
        let at = Point2::new(f64::from(*col) + 0.5, f64::from(*row) + 0.5);
        corner * (at * solid.pixel_m())
    };
    Some(path.iter().rev().map(middle).collect())
}

/// Returns the speeds toward the point of the path that lies ahead; `None` at the end of the path.
fn pursued(path: &[Point2<f64>], pose: &Isometry2<f64>, most: Speeds) -> Option<Speeds> {
    let off = |point: &Point2<f64>| pose.inverse_transform_point(point).coords.norm();
    let nearest = (0..path.len()).min_by(|a, b| off(&path[*a]).total_cmp(&off(&path[*b])))?;
    let ahead = path[nearest..]
        .iter()
        .find(|point| off(point) > LOOKAHEAD_M);
    let target = pose.inverse_transform_point(ahead.or(path.last())?);
    if ahead.is_none() && target.coords.norm() < ARRIVED_M {
        return None;
    }
    let angle_rad = target.y.atan2(target.x);
    let forward_mps = match angle_rad.abs() > 0.8 {
        true => 0.0,
        false => most.forward_mps * angle_rad.cos(),
    };
    Some(Speeds {
        forward_mps,
        turn_radps: (2.5 * angle_rad).clamp(-most.turn_radps, most.turn_radps),
    })
}

/// The result of a drive: whether the robot stands in the goal, the time, the way, and the steps with a
/// contact.
struct Outcome {
    arrived: bool,
    time_s: f64,
    way_m: f64,
    touched: u32,
}

/// Drives to the goal: by the policy, or along a path with the driver's estimate of the pose.
fn drive(
    setup: &DriveSetup,
    seed: u64,
    path: Option<&[Point2<f64>]>,
) -> Result<Outcome, Box<dyn Error>> {
    let physics = setup.physics().clone();
    let most = Speeds {
        forward_mps: physics.max_speed_mps,
        turn_radps: physics.max_turn_radps,
    };
    let mut robot = SimulatedRobot::new(setup.maze().clone(), &physics, seed, None)?;
    let mut driver = Driver::new(setup.clone());
    let grid = setup
        .maze()
        .grid_in_map()
        .unwrap_or_else(Isometry2::identity);
    let mount = Transform {
        parent: "base_link".to_owned(),
        child: "base_scan".to_owned(),
        pose: Isometry3::identity(),
    };
    let (mut way_m, mut touched, mut last) = (0.0, 0, robot.true_pose());
    for number in 1..=MOST_STEPS {
        let arrived = robot.step();
        way_m += (last.inverse() * robot.true_pose())
            .translation
            .vector
            .norm();
        touched += u32::from(robot.impulse_n_s() > 0.0);
        last = robot.true_pose();
        let readings = Readings {
            scans: arrived.scan.into_iter().collect(),
            odometry: vec![arrived.odometry],
            imu: arrived.imu.into_iter().collect(),
            static_transforms: vec![mount.clone()],
            ..Readings::default()
        };
        let step = driver.step(number * STEP_NS, &readings);
        let has_failed = step.faults.iter().any(Fault::is_final);
        let command = match (path, &step.belief) {
            (Some(path), Some(belief)) => {
                pursued(path, &(grid.inverse() * belief.robot_in_map), most)
            }
            (Some(_), None) => Some(Speeds::REST),
            (None, _) => {
                (!matches!(step.phase, Phase::AtGoal | Phase::OutOfSteps)).then_some(step.command)
            }
        };
        let Some(command) = command.filter(|_| path.is_some() || !has_failed) else {
            let arrived = robot.is_at_goal();
            let time_s = (number * STEP_NS) as f64 * 1e-9;
            return Ok(Outcome {
                arrived,
                time_s,
                way_m,
                touched,
            });
        };
        robot.command(command);
    }
    let time_s = (MOST_STEPS * STEP_NS) as f64 * 1e-9;
    Ok(Outcome {
        arrived: false,
        time_s,
        way_m,
        touched,
    })
}

/// Runs the example.
pub fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let run = arguments
        .next()
        .ok_or("usage: compare_with_planner RUN [DRIVES [FIRST SEED]]")?;
    let drives: u64 = arguments.next().map_or(Ok(20), |text| text.parse())?;
    let first: u64 = arguments.next().map_or(Ok(1), |text| text.parse())?;
    let folder = RunFolder::open(Path::new(&run));
    let setup = DriveSetup::new(
        &folder.plan()?,
        &folder.knowledge()?,
        DriveOptions::default(),
    )?;
    let maze = setup.maze();
    let start = maze.start().ok_or("the world has no start")?;
    let ends = [start, maze.goals()[0]].map(|cell| maze.centre_in_grid(cell));
    let path =
        planned(maze, ends, setup.physics().radius_m + MARGIN_M).ok_or("no path to the goal")?;
    println!("by       arrived  time s  way m  drives with contacts");
    for (name, path) in [("policy", None), ("planner", Some(&path[..]))] {
        let all = (first..first + drives).map(|seed| drive(&setup, seed, path));
        let all = all.collect::<Result<Vec<_>, _>>()?;
        let good: Vec<&Outcome> = all.iter().filter(|one| one.arrived).collect();
        let mean = |value: fn(&Outcome) -> f64| {
            good.iter().map(|one| value(one)).sum::<f64>() / good.len() as f64
        };
        let touched = all.iter().filter(|one| one.touched > 0).count();
        let (time_s, way_m) = (mean(|one| one.time_s), mean(|one| one.way_m));
        println!(
            "{name:8} {:>2} of {drives:<3} {time_s:6.1} {way_m:6.2}  {touched}",
            good.len()
        );
    }
    Ok(())
}
