//! Cells that pay once in an episode, and a learner that remembers them.

use std::sync::Arc;

use xcscr::agent::{Explorer, Frozen, Method, Params};
use xcscr::arena::{Arena, Outcome};
use xcscr::episode::{self, Ending, Observer, Step};
use xcscr::streams::StreamName;
use xcscr::trial::Plan;
use xcscr::world::{Cell, Maze};
use xcscr::xcs::random::Stream;

use crate::learned::{Learned, learned, mapped, with};

/// A world whose marked cells pay a reward.
pub fn paid(rows: &[&str], reward: f64) -> Maze {
    let text = format!(r#"{{ "rows": {rows:?}, "reward": {reward} }}"#);
    Maze::from_json(text.as_bytes(), "paid.json").unwrap()
}

fn finished(rows: &[&str], reward: f64, episodes: u32, slip: f64) -> Arc<Learned> {
    let plan = mapped(paid(rows, reward), Method::XcscrPlus);
    let plan = with(plan, |settings| settings.arena.slip = slip);
    learned(plan.episodes(episodes).seed(3))
}

fn arena(learned: &Learned) -> Box<dyn Arena> {
    learned.plan.config.build_arena(&learned.plan.maze).unwrap()
}

/// What an episode brought: its discounted rewards, the auxiliary ones that were found, and its steps.
#[derive(Debug, Default)]
struct Brought {
    value: f64,
    found: u32,
    steps: u32,
}

impl Observer for Brought {
    fn stepped(&mut self, step: &Step<'_>) {
        let params = Params::default();
        let mut reward = params.short_term(step.outcome);
        if step.outcome == Outcome::ReachedGoal {
            reward += params.goal;
        }
        self.value += params.gamma.powi(self.steps as i32) * reward;
        self.found += u32::from(step.outcome.found() > 0.0);
        self.steps += 1;
    }
}

/// Follows what was learned, with everything frozen.
fn drive(learned: &Learned, arena: &mut dyn Arena, start: Cell) -> Brought {
    let Plan { maze, config } = &learned.plan;
    let limit = config.settings.reward.step_threshold;
    let mut policy = Frozen::new(learned.knowledge.clone(), maze.action_count(), limit);
    let mut greedy = Explorer::new(0.0, Stream::new(1, StreamName::Exploration));
    let (mut brought, sensor) = (Brought::default(), config.sensor);
    let (policy, greedy) = (&mut policy, &mut greedy);
    let (episode, _) = episode::run(1, start, arena, sensor, policy, greedy, &mut brought);
    assert_eq!(episode.ending, Ending::Goal, "from {start:?}");
    brought
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
const START: Cell = Cell { col: 1, row: 1 };

/// A world with three auxiliary rewards.
pub const SIX: [&str; 7] = [
    "##########",
    "#..#...#.#",
    "#*.....#.#",
    "#..#.#...#",
    "####.#.#.#",
    "#*...#G#*#",
    "##########",
];

#[test]
fn a_detour_is_made_for_a_reward_that_is_worth_it_and_only_for_such_a_one() {
    // Straight on: 0.9^3 of the goal. By way of the reward: 0.9 of it, and 0.9^7 of the goal.
    for (reward, found, steps) in [(200.0, 0, 4), (400.0, 1, 8)] {
        let trial = finished(&BESIDE, reward, 30, 0.0);
        let brought = drive(&trial, &mut *arena(&trial), START);
        assert_eq!((brought.found, brought.steps), (found, steps), "{reward}");
    }
}

#[test]
fn from_every_start_that_it_recognises_it_gets_as_much_as_can_be_had() {
    for reward in [40.0, 400.0, 2000.0] {
        let trial = finished(&SIX, reward, 200, 0.0);
        let (maze, sensor) = (&trial.plan.maze, trial.plan.config.sensor);
        let look = |cell| sensor.perceive_at(maze, cell);
        let unlike = |start: &Cell| {
            let alike = maze.starts().filter(|&other| look(other) == look(*start));
            alike.count() == 1
        };
        let mut found = 0;
        for start in maze.starts().filter(unlike) {
            let brought = drive(&trial, &mut *arena(&trial), start);
            let best = best(maze, start, 60);
            let what = format!("reward {reward}, from {start:?}: {brought:?}");
            assert!(brought.value > best - 1e-6, "{what}, but {best} can be had");
            found += brought.found;
        }
        assert!(found > 0, "reward {reward}: none was found");
    }
}

#[test]
fn where_moves_slip_rewards_are_sought_all_the_same() {
    let found = |reward| {
        let trial = finished(&BESIDE, reward, 100, 0.1);
        let mut arena = arena(&trial);
        let drives = (0..40).map(|_| drive(&trial, &mut *arena, START));
        drives.map(|brought| brought.found).sum::<u32>()
    };
    let (little, much) = (found(50.0), found(800.0));
    assert!(little < 10 && much > 36, "{little} and {much} of 40");
}
