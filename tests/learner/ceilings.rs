//! What tabular methods reach in the paper's mazes, and that `xcscr-plus` goes below it.

use std::sync::Arc;

use xcscr::agent::Method;
use xcscr::sensor::Sensor;
use xcscr::trial::Plan;
use xcscr::world::Maze;

use crate::kit::chance::rounds;
use crate::learner::learned::{Learned, gridded, learned, with, world};

const MAZES: [&str; 3] = ["maze4", "maze5", "maze6"];

/// Trials with different seeds.
fn trials(plan: Plan) -> Vec<Arc<Learned>> {
    let seeds = 1..=rounds([5, 20, 20]) as u64;
    seeds.map(|seed| learned(plan.clone().seed(seed))).collect()
}

/// Each pair of percept and action must be tried.
fn without_generalisation(plan: Plan) -> Plan {
    with(plan, |settings| {
        settings.plus.collision_rules = false;
        settings.plus.return_rules = false;
    })
}

fn median(mut numbers: Vec<u64>) -> u64 {
    numbers.sort_unstable();
    numbers[numbers.len() / 2]
}

/// The median first optimal episode, where all trials had one.
fn median_episode(trials: &[Arc<Learned>]) -> Option<u64> {
    let first = |one: &Arc<Learned>| one.progress.first_optimal_episode.map(u64::from);
    trials.iter().map(first).collect::<Option<_>>().map(median)
}

/// The median steps in the environment until then.
fn median_steps(trials: &[Arc<Learned>]) -> u64 {
    let first = |one: &Arc<Learned>| one.progress.first_optimal_env_steps.unwrap_or(u64::MAX);
    median(trials.iter().map(first).collect())
}

/// The trials that are optimal at the end.
fn optimal(trials: &[Arc<Learned>]) -> usize {
    trials.iter().filter(|one| one.progress.optimal).count()
}

/// R-max has found an optimum long before the last episode.
fn r_max(maze: &str) -> Vec<Arc<Learned>> {
    let plan = gridded(world(maze), Method::RMax).episodes(20);
    trials(without_generalisation(plan))
}

#[test]
fn tabular_methods_need_as_many_episodes_as_in_other_programs() {
    for (at, (r_max_needs, q_learning_needs)) in [(2, 11), (4, 25), (4, 27)].iter().enumerate() {
        let maze = MAZES[at];
        let q_learning = trials(gridded(world(maze), Method::QLearning).episodes(60));
        for (trials, expected, most) in [
            (r_max(maze), *r_max_needs, 1),
            (q_learning, *q_learning_needs, 3),
        ] {
            let median = median_episode(&trials);
            let is_near = median.is_some_and(|median| median.abs_diff(expected) <= most);
            assert!(is_near, "{maze}: {median:?}, {expected} expected");
        }
    }
}

#[test]
fn xcscr_plus_is_always_optimal_within_three_episodes_and_in_fewer_steps_than_r_max_without_generalisation()
 {
    for maze in MAZES {
        let ours = trials(gridded(world(maze), Method::XcscrPlus).episodes(60));
        let (steps, ceiling) = (median_steps(&ours), median_steps(&r_max(maze)));
        assert!(steps < ceiling, "{maze}: {steps} steps, R-max {ceiling}");
        let episode = median_episode(&ours);
        assert!(episode.is_some_and(|e| e <= 3), "{maze}: {episode:?}");
        assert_eq!(optimal(&ours), ours.len(), "{maze}");
    }
}

#[test]
fn without_planned_exploration_xcscr_plus_takes_more_than_three_times_the_steps() {
    let [planned, random] = [true, false].map(|planned| {
        let plan = gridded(world("maze5"), Method::XcscrPlus).episodes(60);
        let plan = with(plan, |settings| settings.plus.planned_exploration = planned);
        median_steps(&trials(plan))
    });
    assert!(random > 3 * planned, "{planned} and {random} steps");
}

/// A room of 5 x 5 cells with eight moves and random starts.
const ROOM: &str = r########"{ "moves": 8, "rows": [
    "#######", "#.....#", "#.....#", "#...G.#", "#.....#", "#.....#", "#######"
] }"########;

#[cfg(feature = "long")]
#[test]
fn xcscr_plus_takes_about_the_steps_of_r_max_and_without_generalisation_it_takes_more() {
    let maze = Maze::from_json(ROOM.as_bytes(), "room.json").unwrap();
    let plan = |method| {
        let plan = gridded(maze.clone(), method).episodes(200);
        plan.sensor(Sensor::NeighboursPosition)
    };
    let [ours, with, without] = [
        plan(Method::XcscrPlus),
        plan(Method::RMax),
        without_generalisation(plan(Method::RMax)),
    ]
    .map(|plan| {
        let trials = trials(plan);
        assert_eq!(optimal(&trials), 20);
        median_steps(&trials)
    });
    let steps = format!("{ours} steps; R-max {with}, without generalisation {without}");
    assert!(20 * ours <= 21 * with, "{steps}");
    assert!(2 * without > 3 * with, "control: {steps}");
}
