//! What tabular methods reach in the paper's mazes, and that `xcscr-plus` goes below it.

use std::sync::LazyLock;

use xcscr::agent::Method;
use xcscr::arena::ArenaKind;
use xcscr::sensor::Sensor;
use xcscr::trial::{Plan, Progress, Settings};
use xcscr::world::Maze;

const MAZES: [&str; 3] = ["maze4", "maze5", "maze6"];

/// Twenty trials of R-max, planned on what is known, in each of the mazes.
static KNOWN: LazyLock<[Vec<Progress>; 3]> = LazyLock::new(|| {
    MAZES.map(|maze| {
        let maze = shipped(maze);
        let short = (Sensor::Neighbours, R_MAX_EPISODES);
        twenty_in(&maze, short, Method::RMax, &without_generalisation())
    })
});

/// R-max has found an optimum long before.
const R_MAX_EPISODES: u32 = 20;

fn shipped(maze: &str) -> Maze {
    let path = format!("{}/worlds/{maze}.json", env!("CARGO_MANIFEST_DIR"));
    Maze::load(path.as_ref()).unwrap()
}

/// How twenty trials on the grid ended.
fn twenty(method: Method, maze: &str, settings: &Settings) -> Vec<Progress> {
    twenty_in(&shipped(maze), (Sensor::Neighbours, 60), method, settings)
}

fn twenty_in(
    maze: &Maze,
    (sensor, episodes): (Sensor, u32),
    method: Method,
    settings: &Settings,
) -> Vec<Progress> {
    let progress = |seed| {
        let plan = Plan::new(maze.clone()).method(method);
        let plan = plan.arena(ArenaKind::Grid).sensor(sensor);
        let plan = plan.episodes(episodes).seed(seed);
        let trial = plan.settings(settings.clone()).run().unwrap();
        trial.progress().clone()
    };
    (1..=20).map(progress).collect()
}

fn median(mut numbers: Vec<u64>) -> u64 {
    numbers.sort_unstable();
    numbers[numbers.len() / 2]
}

/// The median first optimal episode, where all trials had one.
fn median_episode(trials: &[Progress]) -> Option<u64> {
    let first = |one: &Progress| one.first_optimal_episode.map(u64::from);
    trials.iter().map(first).collect::<Option<_>>().map(median)
}

/// The median steps in the environment until then.
fn median_steps(trials: &[Progress]) -> u64 {
    let first = |one: &Progress| one.first_optimal_env_steps.unwrap_or(u64::MAX);
    median(trials.iter().map(first).collect())
}

/// R-max without generalisation: each pair of percept and action must be tried.
fn without_generalisation() -> Settings {
    let mut settings = Settings::default();
    settings.plus.collision_rules = false;
    settings.plus.return_rules = false;
    settings
}

#[test]
fn r_max_without_generalisation_needs_two_to_four_episodes() {
    // Known from other programs: 2, 4, 4.
    for ((maze, trials), expected) in MAZES.iter().zip(&*KNOWN).zip([2_u64, 4, 4]) {
        let median = median_episode(trials);
        assert!(
            median.is_some_and(|m| m.abs_diff(expected) <= 1),
            "{maze}: {median:?}, {expected} expected"
        );
    }
}

#[test]
fn q_learning_needs_about_11_25_and_27_episodes() {
    for (maze, expected) in [("maze4", 11_u64), ("maze5", 25), ("maze6", 27)] {
        let trials = twenty(Method::QLearning, maze, &Settings::default());
        let median = median_episode(&trials);
        assert!(
            median.is_some_and(|m| m.abs_diff(expected) <= 3),
            "{maze}: {median:?}, {expected} expected"
        );
    }
}

#[test]
fn xcscr_plus_is_always_optimal_within_three_episodes_and_in_fewer_steps_than_r_max_without_generalisation()
 {
    for (maze, theirs) in MAZES.iter().zip(&*KNOWN) {
        let ours = twenty(Method::XcscrPlus, maze, &Settings::default());
        let (steps, ceiling) = (median_steps(&ours), median_steps(theirs));
        assert!(steps < ceiling, "{maze}: {steps} steps, R-max {ceiling}");
        let episode = median_episode(&ours);
        assert!(episode.is_some_and(|e| e <= 3), "{maze}: {episode:?}");
        let retained = ours.iter().filter(|one| one.optimal).count();
        assert_eq!(retained, ours.len(), "{maze}");
    }
}

#[test]
fn without_planned_exploration_xcscr_plus_often_fails() {
    let mut settings = Settings::default();
    settings.plus.planned_exploration = false;
    let trials = twenty(Method::XcscrPlus, "maze5", &settings);
    let found = trials.iter().filter(|one| one.optimal).count();
    assert!(found <= 10, "{found} of 20 were optimal all the same");
}

/// A room of 5 x 5 cells with eight moves and random starts.
const ROOM: &str = r########"{ "moves": 8, "rows": [
    "#######", "#.....#", "#.....#", "#...G.#", "#.....#", "#.....#", "#######"
] }"########;

#[test]
fn xcscr_plus_takes_the_same_steps_as_r_max_and_without_generalisation_both_take_more() {
    let maze = Maze::from_json(ROOM.as_bytes(), "room.json").unwrap();
    let twenty = |method, settings: &Settings| {
        twenty_in(&maze, (Sensor::NeighboursPosition, 200), method, settings)
    };
    let ours = twenty(Method::XcscrPlus, &Settings::default());
    let with = twenty(Method::RMax, &Settings::default());
    let without = twenty(Method::RMax, &without_generalisation());
    for (who, trials) in [("ours", &ours), ("with", &with), ("without", &without)] {
        let optimal = trials.iter().filter(|one| one.optimal).count();
        assert_eq!(optimal, 20, "{who}");
    }
    let [ours, with, without] = [ours, with, without].map(|trials| median_steps(&trials));
    let steps = format!("{ours} steps; R-max {with}, without generalisation {without}");
    assert_eq!(ours, with, "{steps}");
    assert!(2 * without > 3 * with, "control: {steps}");
}
