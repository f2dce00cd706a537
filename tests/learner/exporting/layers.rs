//! Exported percepts in a world from a map: the open moves of the map, and obstacles in a scan.

use std::fs;
use std::path::Path;
use std::process::Command;

use xcscr::agent::Method;
use xcscr::arena::ArenaKind;
use xcscr::export::Target;
use xcscr::sensor::Sensor;
use xcscr::trial::Plan;
use xcscr::world::{Direction, Maze};
use xcscr::xcs::Percept;

use super::program::{compile_c, fed};
use super::text;
use crate::kit::flat::Flat;
use crate::learner::learned::learned;

/// For each line with a point of the map frame and the size of a cell: the percept of the map, and
/// that with something in the east of the robot.
const IN_C: &str = r#"
#include "policy.h"
#include <math.h>
#include <stdio.h>

static void show(const xcscr_word *percept)
{
    int bit;
    for (bit = 0; bit < XCSCR_PERCEPT_BITS; bit++) {
        putchar('0' + (percept[bit / 8] >> (bit % 8) & 1));
    }
    putchar(' ');
}

int main(void)
{
    double x, y;
    while (scanf("%lf %lf", &x, &y) == 2) {
        xcscr_word percept[XCSCR_PERCEPT_BYTES];
        struct xcscr_scan scan;
        int beam, is_inside;
        is_inside = xcscr_percept(x, y, 0, percept);
        show(percept);
        if (!xcscr_scan_begin(&scan, x, y, 0.0, 1.0)) {
            return 1;
        }
        for (beam = -10; beam <= 10; beam++) {
            xcscr_scan_add(&scan, beam * 0.01, -1.0, 0.4 * XCSCR_CELL_SIZE_M);
        }
        xcscr_scan_percept(&scan, percept);
        show(percept);
        printf("%d %d ", is_inside, xcscr_percept(NAN, y, 0, percept));
        printf("%d\n", (int)xcscr_open_actions(&scan));
    }
    return xcscr_is_goal(XCSCR_START_COLUMN, XCSCR_START_ROW);
}
"#;

const IN_PYTHON: &str = r#"
import math, sys
import policy
for line in sys.stdin:
    x, y = map(float, line.split())
    scan = policy.Scan(x, y, 0.0, 1.0)
    for beam in range(-10, 11):
        scan.add(beam * 0.01, -1.0, 0.4 * policy.CELL_SIZE_M)
    try:
        policy.percept(math.nan, y)
        refused = 1
    except ValueError:
        refused = 0
    print(policy.percept(x, y), scan.percept(), 1, refused, sum(1 << at for at in scan.open_actions()))
"#;

/// The answers of a program for the middles of all free cells.
fn answers(target: Target, source: &str, maze: &Maze) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let mut command = match target {
        Target::C99 => {
            write("policy.h", source);
            write("driver.c", IN_C);
            compile_c(folder.path(), "driver.c");
            Command::new(folder.path().join("driver"))
        }
        _ => {
            write("policy.py", source);
            write("driver.py", IN_PYTHON);
            let mut python = Command::new("python3");
            python.arg(Path::new("driver.py"));
            python
        }
    };
    let middles = maze.free_cells().map(|cell| maze.centre_m(cell));
    let lines: String = middles.map(|at| format!("{} {}\n", at.x, at.y)).collect();
    let command = command.current_dir(folder.path());
    let printed = String::from_utf8(fed(command, lines.into_bytes())).unwrap();
    printed.lines().map(str::to_owned).collect()
}

fn shown(percept: &Percept) -> String {
    let bits = (0..percept.width()).map(|bit| if percept.bit(bit) { '1' } else { '0' });
    bits.collect()
}

#[test]
fn exported_percepts_are_those_of_the_map_and_of_obstacles_in_a_scan() {
    let maze = Flat::new().gridded(0.5).maze;
    for (target, sensor) in [
        (Target::C99, Sensor::LidarPosition),
        (Target::C99, Sensor::NeighboursPosition),
        (Target::Python, Sensor::LidarPosition),
        (Target::Python, Sensor::NeighboursPosition),
    ] {
        let plan = Plan::new(maze.clone()).method(Method::QLearning);
        let plan = plan.arena(ArenaKind::Grid).sensor(sensor).episodes(20);
        let learned = learned(plan);
        let found = answers(target, &text(&learned, target), &maze);
        for (cell, found) in maze.free_cells().zip(&found) {
            let expected = sensor.perceive_at(&maze, cell);
            // In these percepts the east is the third of eight cells, with two bits each.
            let mut blocked = shown(&expected);
            if sensor == Sensor::LidarPosition && maze.is_open(cell, Direction::East) {
                blocked.replace_range(4..6, "01");
            }
            let what = format!("{target:?} {sensor:?} {cell:?}");
            let parts: Vec<&str> = found.split(' ').collect();
            assert_eq!(parts[0], shown(&expected), "{what}");
            assert_eq!(parts[2..4], ["1", "0"], "{what}: inside, and no number");
            let is_open = |way: &Direction| maze.is_open(cell, *way) && *way != Direction::East;
            let open = (0..).zip(Direction::MAIN).filter(|(_, way)| is_open(way));
            let open: u32 = open.map(|(at, _)| 1 << at).sum();
            assert_eq!(parts[4], open.to_string(), "{what}: open actions");
            if sensor == Sensor::LidarPosition {
                assert_eq!(parts[1], blocked, "{what}: with an obstacle");
            }
        }
        assert_eq!(found.len(), maze.free_cells().count());
    }
}
