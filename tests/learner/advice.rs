//! The advice of `train` helps: eleven situations in which a plan fails, and what it does once the advice is taken.

use std::ops::Range;

use xcscr::agent::{Estimator, Method};
use xcscr::sensor::Sensor;
use xcscr::trial::Plan;
use xcscr::world::Maze;

use crate::learned::{drawn, gridded, learned, with, world};

/// An office of 44 x 27 cells: a corridor from west to east, and four rooms with a desk on each side of it.
fn office() -> Maze {
    let mut rows = vec![vec![b'#'; 44]; 27];
    let mut fill = |rows_of: Range<usize>, cols: Range<usize>, cell: u8| {
        for row in rows_of {
            rows[row][cols.clone()].fill(cell);
        }
    };
    fill(12..15, 1..43, b'.');
    for room in 0..4 {
        let west = 1 + 11 * room;
        for (north, desk, door) in [(1, 4, 11), (16, 20, 15)] {
            fill(north..north + 10, west..(west + 10).min(43), b'.');
            fill(desk..desk + 2, west + 3..west + 6, b'#');
            fill(door..door + 1, west + 2 + room..west + 3 + room, b'.');
        }
    }
    rows[18][2] = b'S';
    rows[3][40] = b'G';
    let rows: Vec<String> = rows
        .into_iter()
        .map(|row| String::from_utf8(row).unwrap())
        .collect();
    drawn(&rows)
}

/// The world `rooms-12-1` with a reward in one cell.
fn rewarding() -> Maze {
    let text = world("rooms-12-1").to_json();
    let mut world: serde_json::Value = serde_json::from_str(&text).unwrap();
    world["rows"][5] = "#...#*..#..#".into();
    world["reward"] = 100.into();
    Maze::from_json(world.to_string().as_bytes(), "rewarding.json").unwrap()
}

fn plan(maze: Maze, method: Method, sensor: Sensor, episodes: u32) -> Plan {
    let plan = gridded(maze, method).sensor(sensor);
    plan.episodes(episodes).seed(1)
}

/// Eleven plans that fail, and the advice for each.
fn situations() -> [(Plan, &'static str); 11] {
    use Method::{DynaQ, QLearning, RMax, Xcs, Xcscr, XcscrPlus};
    use Sensor::{Lidar, LidarBeams, LidarRanges, Neighbours, Position};
    let plus = |maze: &str, episodes| plan(world(maze), XcscrPlus, Neighbours, episodes);
    // Episodes that end before the goal.
    let short = with(plus("maze5", 60), |settings| {
        settings.reward.step_threshold = 8;
        settings.reward.step_threshold_from_maze = false;
    });
    // The percept as the state where cells share it.
    let percept = with(plus("dfs-12-1", 60), |settings| {
        settings.plus.estimator = Estimator::Percept;
    });
    // Exploration by chance.
    let chance = with(plus("maze5", 40), |settings| {
        settings.plus.planned_exploration = false;
    });
    // Tables where cells share a percept, on ranges that mislead, and with few episodes.
    let shared = plan(world("dfs-12-1"), QLearning, Neighbours, 60);
    let misled = plan(world("dfs-12-1"), RMax, LidarRanges, 60);
    let few = plan(world("rooms-12-1"), DynaQ, Neighbours, 3);
    [
        (
            plan(world("maze6"), Xcs, Neighbours, 60),
            "--method xcscr-plus",
        ),
        (
            plan(office(), Xcscr, Lidar, 60),
            "--method xcscr-plus --sensor lidar-position",
        ),
        (
            plan(office(), XcscrPlus, LidarBeams, 60),
            "--sensor lidar-position",
        ),
        (shared, "--method xcscr-plus"),
        (short, "--set reward.step_threshold=48"),
        (percept, "--set plus.estimator=auto"),
        (plus("rooms-20-3", 1), "--episodes 30"),
        (chance, "--set plus.planned_exploration=true"),
        (misled, "--sensor lidar-position"),
        (
            plan(rewarding(), XcscrPlus, Position, 60),
            "--sensor neighbours",
        ),
        (few, "--method xcscr-plus --episodes 30"),
    ]
}

#[test]
fn in_eleven_failing_situations_the_advice_is_taken_and_helps() {
    let ends_optimal = |plan: Plan| learned(plan).progress.optimal;
    for (plan, expected) in situations() {
        let advice = plan.advice().unwrap();
        assert_eq!(advice.to_string(), expected);
        let advised = advice.applied_to(&plan).unwrap();
        assert!(!ends_optimal(plan), "control: {expected}");
        assert!(ends_optimal(advised), "{advice}");
    }
}

#[test]
fn a_warning_before_the_start_gives_the_same_advice_as_far_as_it_concerns_what_it_warns_of() {
    let mut warned = 0;
    for (plan, expected) in situations() {
        let warnings = plan.warnings();
        warned += usize::from(!warnings.is_empty());
        for warning in warnings {
            let text = warning.to_string();
            let (_, advice) = text.split_once("; try `").unwrap_or(("", ""));
            let advice = advice.trim_end_matches('`');
            let is_same = !advice.is_empty() && expected.contains(advice);
            assert!(is_same, "{expected}: {text}");
        }
    }
    assert!(warned >= 3, "control: {warned}");
}
