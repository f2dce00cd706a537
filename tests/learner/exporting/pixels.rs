//! The whole way: a map is converted and learned, and the exported policy drives in its pixels.

use std::fs;
use std::process::Command;

use xcscr::agent::Method;
use xcscr::episode::{Observer, Step};
use xcscr::export::Target;
use xcscr::sensor::Sensor;
use xcscr::trial::{Evaluation, Plan, RobotProfile, Settings};
use xcscr::world::{Cell, Maze};

use super::program::{compile_c, fed};
use super::text;
use crate::kit::flat::{self, Flat};
use crate::learner::learned::{Learned, learned};

/// The policy of a TurtleBot3 in the flat.
fn learned_flat() -> std::sync::Arc<Learned> {
    let burger = RobotProfile::load("turtlebot3-burger").unwrap();
    let settings = burger
        .settings_over(&Settings::of(Method::XcscrPlus))
        .unwrap();
    let plan = Plan::new(Flat::new().gridded(0.5).maze).settings(settings);
    learned(plan.sensor(Sensor::LidarPosition).episodes(60))
}

/// The cells that the policy comes to on a maze.
fn path(learned: &Learned) -> Vec<Cell> {
    let (maze, sensor) = (&learned.plan.maze, learned.plan.config.sensor);
    let mut cell = maze.start().unwrap();
    let mut path = Vec::new();
    while !maze.is_goal(cell) && path.len() < 100 {
        let values = learned.knowledge.values(&sensor.perceive_at(maze, cell), 4);
        let best = xcscr::xcs::Action::all(4).find(|&action| values.is_nearly_best(action));
        let direction = maze.direction(best.unwrap()).unwrap();
        cell = maze.step(cell, direction).unwrap_or(cell);
        path.push(cell);
    }
    path
}

/// The cells to which a disc comes among the pixels of the flat, and the number of contacts.
fn driven(header: &str, radius_m: f64) -> (Vec<Cell>, u32) {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let [width, height] = flat::SIZE;
    let middle = |number: usize| (number as f64 + 0.5) * flat::PIXEL_M;
    let letter = |col, row| match flat::is_solid(middle(col), middle(row)) {
        true => '#',
        false => '.',
    };
    let row = |row| (0..width).map(|col| letter(col, row)).collect::<String>();
    let rows: Vec<String> = (0..height).map(|at| format!("{:?}", row(at))).collect();
    let constants = [
        format!("#define WIDTH {width}\n#define HEIGHT {height}\n"),
        format!(
            "#define PIXEL_M {}\n#define RADIUS_M {radius_m}\n",
            flat::PIXEL_M
        ),
        format!(
            "static const char *pixels[HEIGHT] = {{{}}};\n",
            rows.join(",\n")
        ),
    ];
    write("pixels.h", &constants.concat());
    write("policy.h", header);
    write("driver.c", include_str!("pixels.c"));
    compile_c(folder.path(), "driver.c");
    let printed = fed(&mut Command::new(folder.path().join("driver")), Vec::new());
    let printed = String::from_utf8(printed).unwrap();
    let mut lines: Vec<&str> = printed.lines().collect();
    let contacts = lines.pop().unwrap().parse().unwrap();
    let cell = |line: &&str| {
        let mut numbers = line.split(' ').map(|number| number.parse().unwrap());
        let (col, row) = (numbers.next().unwrap(), numbers.next().unwrap());
        Cell { col, row }
    };
    (lines.iter().map(cell).collect(), contacts)
}

#[test]
fn a_policy_learned_in_a_map_drives_in_its_pixels_as_in_the_simulator() {
    let learned = learned_flat();
    assert!(learned.progress.optimal, "{:?}", learned.progress);
    let mut trial = learned.plan.clone().run().unwrap();
    let evaluated = Evaluation::after(&mut trial, 3).unwrap();
    assert!(evaluated.is_optimal(), "{evaluated:?}");
    let (cells, contacts) = driven(&text(&learned, Target::C99), 0.105);
    assert_eq!(cells, path(&learned));
    assert!(learned.plan.maze.is_goal(*cells.last().unwrap()));
    assert_eq!(contacts, 0);
    let (_, contacts) = driven(&text(&learned, Target::C99), 0.35);
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
