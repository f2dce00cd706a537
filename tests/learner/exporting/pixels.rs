//! The whole way: a map is converted and learned, and the exported policy drives in its pixels.

use xcscr::agent::Method;
use xcscr::episode::{Observer, Step};
use xcscr::export::Target;
use xcscr::sensor::Sensor;
use xcscr::trial::{Evaluation, Plan, RobotProfile, Settings};
use xcscr::world::{Cell, Maze};
use xcscr::xcs::Percept;

use super::program::{Program, Questions};
use super::text;
use crate::kit::flat::{self, Flat};
use crate::learner::learned::{Learned, learned};

/// The policy of a TurtleBot3 in the flat.
fn learned_flat() -> std::sync::Arc<Learned> {
    let burger = RobotProfile::load("turtlebot3-burger").unwrap();
    let settings = burger
        .settings_over(&Settings::of(Method::XcscrPlus))
        .unwrap();
    let plan = Plan::new(Flat::new().gridded(0.5).maze)
        .method(Method::XcscrPlus)
        .settings(settings);
    learned(plan.sensor(Sensor::LidarPosition).episodes(60))
}

/// The cells that the policy comes to on a maze.
fn path(learned: &Learned) -> Vec<Cell> {
    let (maze, sensor) = (&learned.plan.maze, learned.plan.config.sensor);
    let mut cell = maze.start().unwrap();
    let mut path = Vec::new();
    while !maze.is_goal(cell) && path.len() < 100 {
        let values = learned.knowledge.values(&sensor.perceive_at(maze, cell), 4);
        let best = values.best_actions().next().unwrap();
        let direction = maze.direction(best).unwrap();
        cell = maze.step(cell, direction).unwrap_or(cell);
        path.push(cell);
    }
    path
}

/// The edge of a disc's parts and the length of a part of a beam, in metres.
const FINE_M: f64 = 0.01;

/// Returns true if a disc has a point in a solid pixel.
fn touches([x, y]: [f64; 2], radius_m: f64) -> bool {
    let parts = (radius_m / FINE_M) as i32;
    let offsets = || (-parts..=parts).map(|part| f64::from(part) * FINE_M);
    let points = offsets().flat_map(|north| offsets().map(move |east| (east, north)));
    points
        .filter(|(east, north)| east.hypot(*north) <= radius_m)
        .any(|(east, north)| flat::is_solid(x + east, y + north))
}

/// Returns the action that a program chooses at a point; -1 for none.
fn decided(program: &Program, at_m: [f64; 2]) -> i16 {
    let mut place = Questions::default();
    place.say('x', &at_m);
    let percept: Percept = program.answers(&place)[0].parse().unwrap();
    let mut decision = Questions::default();
    decision.ask('d', &percept.words()[..1]);
    program.answers(&decision)[0].parse().unwrap()
}

/// Returns the middle of a cell, in metres.
fn middle_m(program: &Program, cell: Cell) -> [f64; 2] {
    let mut question = Questions::default();
    question.of('p', cell);
    let answer = program.answers(&question).remove(0);
    let (x, y) = answer.split_once(' ').unwrap();
    [x, y].map(|bits| f64::from_bits(u64::from_str_radix(bits, 16).unwrap()))
}

/// Returns the cell of a point.
fn cell_at(program: &Program, at_m: [f64; 2]) -> Cell {
    let mut question = Questions::default();
    question.say('c', &at_m);
    let answer = program.answers(&question).remove(0);
    let (col, row) = answer.split_once(' ').unwrap();
    let [col, row] = [col, row].map(|number| number.parse().unwrap());
    Cell { col, row }
}

/// An independent kinematic simulation: a disc drives among the pixels of the flat as an exported policy decides.
/// Returns the cells that it comes to, and the number of times that it touched something.
fn driven(learned: &Learned, radius_m: f64) -> (Vec<Cell>, usize) {
    const STEPS: [[f64; 2]; 4] = [[0.0, 1.0], [1.0, 0.0], [0.0, -1.0], [-1.0, 0.0]];
    let maze = &learned.plan.maze;
    let program = Program::new(Target::C99, &text(learned, Target::C99));
    let mut at_m = middle_m(&program, maze.start().unwrap());
    let (mut cells, mut contacts) = (Vec::new(), 0);
    while !cells.last().is_some_and(|&cell| maze.is_goal(cell)) && cells.len() < 100 {
        let Ok(action) = usize::try_from(decided(&program, at_m)) else {
            break;
        };
        for _ in 0..100 {
            for (at_m, step) in at_m.iter_mut().zip(STEPS[action]) {
                *at_m += 0.01 * maze.cell_size_m() * step;
            }
            contacts += usize::from(touches(at_m, radius_m));
        }
        let cell = cell_at(&program, at_m);
        at_m = middle_m(&program, cell);
        cells.push(cell);
    }
    (cells, contacts)
}

#[test]
fn a_policy_learned_in_a_map_drives_in_its_pixels_as_in_the_simulator() {
    let learned = learned_flat();
    assert!(learned.progress.optimal, "{:?}", learned.progress);
    let mut trial = learned.plan.clone().run().unwrap();
    let evaluated = Evaluation::after(&mut trial, 3).unwrap();
    assert!(evaluated.is_optimal(), "{evaluated:?}");
    let (cells, contacts) = driven(&learned, 0.105);
    assert_eq!(cells, path(&learned));
    assert!(learned.plan.maze.is_goal(*cells.last().unwrap()));
    assert_eq!(contacts, 0);
    let (_, contacts) = driven(&learned, 0.35);
    assert!(contacts > 0, "control: a larger disc touches something");
}

/// The true cells of the robot after its steps.
#[derive(Default)]
struct Visited(Vec<Cell>);

impl Observer for Visited {
    fn stepped(&mut self, step: &Step<'_>) {
        let at = step.view.now().robot_in_map.translation.vector;
        self.0.extend(step.view.maze.cell_at(at.into()));
    }
}

#[test]
fn a_box_that_is_not_in_the_map_is_seen_and_the_robot_takes_another_way() {
    let learned = learned_flat();
    let route = path(&learned);
    let at = route[route.len() / 2];
    let drives = |maze: Maze| {
        let plan = Plan {
            maze,
            config: learned.plan.config.clone(),
        };
        let mut visited = Visited::default();
        let found = Evaluation::observed(&plan, &learned.knowledge, 4, &mut visited).unwrap();
        (found, visited.0.contains(&at))
    };
    let (unchanged, was_there) = drives(learned.plan.maze.clone());
    assert!(
        unchanged.is_optimal() && was_there,
        "control: {unchanged:?}"
    );
    let boxed = learned.plan.maze.with_box(at, 0.4).unwrap();
    let (found, was_there) = drives(boxed);
    assert_eq!((found.successes, was_there), (4, false), "{found:?}");
}
