//! The advice of `train` helps: ten situations in which a plan fails, and what it does once the advice is taken.

use xcscr::agent::{Estimator, Method};
use xcscr::arena::ArenaKind;
use xcscr::sensor::Sensor;
use xcscr::trial::Plan;
use xcscr::world::{Maze, Recipe};

use super::kit::trial::maze;

/// An office of 44 x 27 cells: a corridor from west to east, and four rooms with a desk on each side of it.
fn office() -> Maze {
    let mut rows = vec![vec![b'#'; 44]; 27];
    let mut fill = |rows_of: std::ops::Range<usize>, cols: std::ops::Range<usize>, cell: u8| {
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
    let text = format!(r#"{{ "rows": {rows:?} }}"#);
    Maze::from_json(text.as_bytes(), "office.json").unwrap()
}

fn generated(recipe: &str) -> Maze {
    recipe.parse::<Recipe>().unwrap().maze().unwrap()
}

fn plan(maze: Maze, method: Method, sensor: Sensor, episodes: u32) -> Plan {
    let plan = Plan::new(maze).method(method).arena(ArenaKind::Grid);
    plan.sensor(sensor).episodes(episodes).seed(1)
}

fn with(mut plan: Plan, change: impl FnOnce(&mut Plan)) -> Plan {
    change(&mut plan);
    plan
}

fn ends_optimal(plan: Plan) -> bool {
    plan.run().unwrap().progress().optimal
}

/// What fails, and the advice for it.
fn situations() -> Vec<(&'static str, Plan, &'static str)> {
    use Method::{DynaQ, QLearning, RMax, Xcs, Xcscr, XcscrPlus};
    use Sensor::{Lidar, LidarBeams, LidarRanges, Neighbours};
    vec![
        (
            "standard XCS in a multistep maze",
            plan(maze("maze6"), Xcs, Neighbours, 60),
            "--method xcscr-plus",
        ),
        (
            "a published method in an office of 44 columns",
            plan(office(), Xcscr, Lidar, 60),
            "--method xcscr-plus --sensor lidar-position",
        ),
        (
            "beams of a lidar in the office",
            plan(office(), XcscrPlus, LidarBeams, 60),
            "--sensor lidar-position",
        ),
        (
            "a table where cells share a percept",
            plan(generated("dfs-12-1"), QLearning, Neighbours, 60),
            "--method xcscr-plus",
        ),
        (
            "episodes that end before the goal",
            with(plan(maze("maze5"), XcscrPlus, Neighbours, 60), |plan| {
                plan.config.settings.reward.step_threshold = 8;
                plan.config.settings.reward.step_threshold_from_maze = false;
            }),
            "--set reward.step_threshold=48",
        ),
        (
            "the percept as the state where cells share it",
            with(
                plan(generated("dfs-12-1"), XcscrPlus, Neighbours, 60),
                |plan| {
                    plan.config.settings.plus.estimator = Estimator::Percept;
                },
            ),
            "--set plus.estimator=auto",
        ),
        (
            "one episode",
            plan(generated("rooms-20-3"), XcscrPlus, Neighbours, 1),
            "--episodes 30",
        ),
        (
            "exploration by chance",
            with(plan(maze("maze5"), XcscrPlus, Neighbours, 40), |plan| {
                plan.config.settings.plus.planned_exploration = false;
            }),
            "--set plus.planned_exploration=true",
        ),
        (
            "R-max on ranges that mislead",
            plan(generated("dfs-12-1"), RMax, LidarRanges, 60),
            "--sensor lidar-position",
        ),
        (
            "replay in a table, and few episodes",
            plan(generated("rooms-12-1"), DynaQ, Neighbours, 3),
            "--method xcscr-plus --episodes 30",
        ),
    ]
}

#[test]
fn in_ten_failing_situations_the_advice_is_taken_and_helps() {
    for (situation, plan, expected) in situations() {
        let advice = plan.advice().unwrap();
        assert_eq!(advice.to_string(), expected, "{situation}");
        let advised = advice.applied_to(&plan).unwrap();
        assert!(!ends_optimal(plan), "control: {situation}");
        assert!(ends_optimal(advised), "{situation}: {advice}");
    }
}

#[test]
fn a_warning_before_the_start_gives_the_same_advice_as_far_as_it_concerns_what_it_warns_of() {
    for (situation, plan, expected) in situations() {
        for warning in plan.warnings() {
            let text = warning.to_string();
            let (_, advice) = text.split_once("; try `").unwrap_or(("", ""));
            let advice = advice.trim_end_matches('`');
            assert!(
                !advice.is_empty() && expected.contains(advice),
                "{situation}: {text}"
            );
        }
    }
    let warned = situations()
        .iter()
        .filter(|(_, plan, _)| !plan.warnings().is_empty())
        .count();
    assert!(warned >= 3, "control: {warned}");
}
