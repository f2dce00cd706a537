//! Cells that pay once in an episode, and a learner that remembers them.

use crate::kit::trial::on_a_map;
use xcscr::agent::{Agent, Explorer, Frozen, Method};
use xcscr::arena::{Arena, ArenaKind, Outcome};
use xcscr::sensor::Sensor;
use xcscr::streams::StreamName;
use xcscr::trial::{Plan, Settings, Trial};
use xcscr::world::{Cell, Maze};
use xcscr::xcs::random::Stream;

fn maze(rows: &[&str], reward: f64) -> Maze {
    let text = format!(r#"{{ "rows": {rows:?}, "reward": {reward} }}"#);
    Maze::from_json(text.as_bytes(), "paid.json").unwrap()
}

fn finished(maze: Maze, episodes: u32, slip: f64) -> Trial {
    let mut settings = Settings::default();
    settings.arena.slip = slip;
    let plan = Plan::new(maze).method(Method::XcscrPlus);
    let plan = plan.arena(ArenaKind::Grid).sensor(Sensor::Neighbours);
    let plan = plan.episodes(episodes).seed(3);
    on_a_map(plan.settings(settings)).run().unwrap()
}

fn arena(trial: &Trial) -> Box<dyn Arena> {
    let Plan { maze, config } = trial.plan();
    config.build_arena(maze).unwrap()
}

/// What an episode from a start brought: its discounted rewards, the auxiliary ones that were found,
/// and its steps.
#[derive(Debug, PartialEq)]
struct Brought {
    value: f64,
    found: u32,
    steps: u32,
}

/// Follows what was learned, with everything frozen.
fn drive(trial: &Trial, arena: &mut dyn Arena, start: Cell) -> Brought {
    let Plan { maze, config } = trial.plan();
    let params = &config.settings.reward;
    let knowledge = trial.method().knowledge();
    let mut policy = Frozen::new(knowledge, maze.action_count(), params.step_threshold);
    let mut greedy = Explorer::new(0.0, Stream::new(1, StreamName::Exploration));
    let (mut value, mut share, mut found) = (0.0, 1.0, 0);
    arena.reset(start);
    for steps in 1..=params.step_threshold {
        let array = policy.observe(&config.sensor.perceive(&arena.view()));
        let action = policy.choose(&array, &mut greedy).action;
        let outcome = arena.act(action);
        policy.update(action, outcome);
        value += share * params.short_term(outcome);
        found += u32::from(outcome.found() > 0.0);
        if outcome == Outcome::ReachedGoal {
            value += share * params.goal;
            return Brought {
                value,
                found,
                steps,
            };
        }
        share *= params.gamma;
    }
    panic!(
        "no goal from {start:?} within {} steps",
        params.step_threshold
    );
}

/// The greatest discounted sum of rewards from a start, by trying all ways of up to `steps` steps on
/// a table of cells and of what has been collected.
fn best(maze: &Maze, start: Cell, steps: u32) -> f64 {
    let paying = maze.rewarding_cells();
    let cells: Vec<Cell> = maze.free_cells().collect();
    let index = |cell: Cell, collected: usize| {
        let at = cells.iter().position(|&other| other == cell).unwrap();
        at << paying.len() | collected
    };
    let mut value = vec![0.0; cells.len() << paying.len()];
    for _ in 0..steps {
        let before = value.clone();
        for &cell in cells.iter().filter(|&&cell| !maze.is_goal(cell)) {
            for collected in 0..1 << paying.len() {
                let ways = maze.moves().directions().iter();
                let ways = ways.filter_map(|&along| maze.step(cell, along));
                let way = ways.map(|next| {
                    let bit = paying.iter().position(|&other| other == next);
                    let after = bit.map_or(collected, |bit| collected | 1 << bit);
                    let paid = maze.auxiliary_reward(next).filter(|_| after != collected);
                    match maze.is_goal(next) {
                        true => 999.0,
                        false => paid.unwrap_or(0.0) - 1.0 + 0.9 * before[index(next, after)],
                    }
                });
                value[index(cell, collected)] = way.fold(f64::NEG_INFINITY, f64::max);
            }
        }
    }
    value[index(start, 0)]
}

const BESIDE: [&str; 5] = ["#######", "#S...G#", "#.#####", "#*#####", "#######"];

#[test]
fn a_detour_is_made_for_a_reward_that_is_worth_it_and_only_for_such_a_one() {
    // Straight on: 0.9^3 of the goal. By way of the reward: 0.9 of it, and 0.9^7 of the goal.
    for (reward, found, steps) in [(200.0, 0, 4), (400.0, 1, 8)] {
        let trial = finished(maze(&BESIDE, reward), 30, 0.0);
        let brought = drive(&trial, &mut *arena(&trial), Cell { col: 1, row: 1 });
        assert_eq!((brought.found, brought.steps), (found, steps), "{reward}");
    }
}

#[test]
fn from_every_start_that_it_recognises_it_gets_as_much_as_can_be_had() {
    let rows = [
        "##########",
        "#..#...#.#",
        "#*.....#.#",
        "#..#.#...#",
        "####.#.#.#",
        "#*...#G#*#",
        "##########",
    ];
    for reward in [40.0, 400.0, 2000.0] {
        let trial = finished(maze(&rows, reward), 200, 0.0);
        let maze = &trial.plan().maze;
        let mut found = 0;
        let config = &trial.plan().config;
        let look = |cell| config.sensor.perceive_at(maze, cell);
        let unlike = |start: &Cell| {
            maze.starts()
                .filter(|&other| look(other) == look(*start))
                .count()
                == 1
        };
        for start in maze.starts().filter(unlike) {
            let brought = drive(&trial, &mut *arena(&trial), start);
            let best = best(maze, start, 60);
            assert!(
                brought.value > best - 1e-6,
                "reward {reward}, from {start:?}: {brought:?}, but {best} can be had"
            );
            found += brought.found;
        }
        assert!(found > 0, "reward {reward}: none was found");
    }
}

#[test]
fn where_moves_slip_rewards_are_sought_all_the_same() {
    let found = |reward| {
        let trial = finished(maze(&BESIDE, reward), 100, 0.1);
        let mut arena = arena(&trial);
        let drives = (0..40).map(|_| drive(&trial, &mut *arena, Cell { col: 1, row: 1 }));
        drives.map(|brought| brought.found).sum::<u32>()
    };
    let (little, much) = (found(50.0), found(800.0));
    assert!(little < 10 && much > 36, "{little} and {much} of 40");
}
