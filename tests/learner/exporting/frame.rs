//! Exported source code leads from a pose in metres to a percept as the simulator does.

use std::f64::consts::FRAC_PI_6;
use std::fs;
use std::path::Path;
use std::process::Command;

use nalgebra::{Point2, Rotation2};
use xcscr::agent::Knowledge;
use xcscr::arena::ArenaKind;
use xcscr::export::{Policy, Provenance, Target};
use xcscr::sensor::Sensor;
use xcscr::trial::Plan;
use xcscr::world::{Cell, Direction, Maze};
use xcscr::xcs::random::Stream;

use super::program::{LANGUAGES, Program, Questions, compile_c, fed};
use crate::kit::trial::maze;

/// One rule that matches every percept of a sensor in a maze: what an export has beside its rules does not
/// depend on them.
pub fn exported(target: Target, maze: &Maze, sensor: Sensor, arena: ArenaKind) -> String {
    let plan = Plan::new(maze.clone()).sensor(sensor).arena(arena);
    let (width, actions) = (sensor.width(maze), maze.action_count());
    let rule = format!(
        r#"{{"rules":[{{"condition":"{}","action":0,"prediction":1.0,"error":0.0,"fitness":1.0,
        "numerosity":1,"experience":1,"time_stamp":0,"set_size":1.0}}]}}"#,
        "#".repeat(width)
    );
    let knowledge: Knowledge = serde_json::from_str(&rule).unwrap();
    let policy = Policy::new(&knowledge, width, actions, &sensor.percepts(maze)).unwrap();
    target.text(&policy, &Provenance::new(&plan, &knowledge, true))
}

/// A maze of 0.25 m cells, with the south-western corner of its grid at a pose of the map frame.
fn placed(origin: [f64; 3]) -> Maze {
    let rows = ["########", "#S..#..#", "#.#...##", "#...#.G#", "########"];
    let text = format!(r#"{{ "cell_size_m": 0.25, "origin": {origin:?}, "rows": {rows:?} }}"#);
    Maze::from_json(text.as_bytes(), "placed.json").unwrap()
}

/// A point of the grid frame in the map frame.
pub fn in_map([x_m, y_m, yaw_rad]: [f64; 3], point_m: Point2<f64>) -> [f64; 2] {
    let turned = Rotation2::new(yaw_rad) * point_m;
    [turned.x + x_m, turned.y + y_m]
}

/// Points of the grid frame, some of them outside of the grid.
fn points(maze: &Maze) -> Vec<Point2<f64>> {
    let mut random = Stream::new(3, 0_u64);
    let size_m = maze.cell_size_m();
    let mut along = |cells: u16| (random.unit() * (f64::from(cells) + 2.0) - 1.0) * size_m;
    let mut point = |_| Point2::new(along(maze.width()), along(maze.height()));
    (0..2_000).map(&mut point).collect()
}

const ORIGINS: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [-10.0, 2.5, 0.0], [3.25, -1.5, -FRAC_PI_6]];

#[test]
fn the_cell_of_every_point_and_the_middle_of_every_cell_are_those_of_the_maze() {
    for origin in ORIGINS {
        // The second maze is in the grid frame.
        let [maze, plain] = [origin, [0.0; 3]].map(placed);
        let named = |cell: Option<Cell>| match cell {
            Some(Cell { col, row }) => format!("{col} {row}"),
            None => "outside".to_owned(),
        };
        let (points, mut questions, mut wanted) = (points(&maze), Questions::about(&maze), vec![]);
        let middles = maze.cells().map(|cell| plain.centre_m(cell));
        for at in points.iter().copied().chain(middles) {
            questions.say('c', &in_map(origin, at));
            wanted.push(named(plain.cell_at(at)));
        }
        for nowhere in [[f64::NAN, 0.0], [0.0, f64::INFINITY]] {
            questions.say('c', &nowhere);
            wanted.push(named(None));
        }
        maze.cells().for_each(|cell| questions.of('p', cell));
        let outside = wanted.iter().filter(|one| *one == "outside").count();
        assert!(outside > 200 && outside < 1_800, "{outside}");
        for target in LANGUAGES {
            let name = format!("{} {origin:?}", target.name());
            let policy = exported(target, &maze, Sensor::Lidar, ArenaKind::Grid);
            let answers = Program::new(target, &policy).answers(&questions);
            let (cells, middles) = answers.split_at(wanted.len());
            assert_eq!(cells, wanted, "{name}");
            for (cell, answer) in maze.cells().zip(middles) {
                let bits = answer.split(' ').map(|bits| u64::from_str_radix(bits, 16));
                let found: Vec<f64> = bits.map(|bits| f64::from_bits(bits.unwrap())).collect();
                let [x, y] = in_map(origin, plain.centre_m(cell));
                let off = (found[0] - x).abs().max((found[1] - y).abs());
                assert!(off < 1e-12, "{name}: {cell:?}: {found:?}, not {x} {y}");
            }
        }
    }
}

/// Compiles a policy for a machine whose `double` has 32 bits, with a program that reads points and prints cells. Returns
/// what the compiler says.
fn compile_for_32_bits(folder: &Path, policy: &str, options: &str) -> (bool, String) {
    let main = r#"#include <stdio.h>
#include "policy.h"
int main(void) {
    float x, y;
    while (scanf("%f %f", &x, &y) == 2) {
        uint16_t column, row;
        if (xcscr_cell_from_pose(x, y, &column, &row)) printf("%u %u\n", column, row);
        else printf("outside\n");
    }
    return 0;
}
"#;
    fs::write(folder.join("policy.h"), policy).unwrap();
    fs::write(folder.join("main.c"), main).unwrap();
    let mut compiler = Command::new("cc");
    let single = "-std=c99 -O1 -Wno-builtin-macro-redefined -U__DBL_MANT_DIG__ -D__DBL_MANT_DIG__=24 -Ddouble=float -fsingle-precision-constant main.c -o main";
    compiler
        .args(single.split(' '))
        .args(options.split_whitespace());
    let output = compiler.current_dir(folder).output().unwrap();
    (
        output.status.success(),
        String::from_utf8_lossy(&output.stderr).into_owned(),
    )
}

#[test]
fn cells_keep_the_centimetre_in_32_bits_however_far_the_origin_is() {
    let folder = tempfile::tempdir().unwrap();
    for (far, origin) in [
        (false, ORIGINS[2]),
        (true, [4e5, -5.2e6, 0.3]),
        (true, [1e8, 1e8, -2.0]),
    ] {
        let [maze, plain] = [origin, [0.0; 3]].map(placed);
        let policy = exported(Target::C99, &maze, Sensor::Lidar, ArenaKind::Grid);
        let (compiles, said) = compile_for_32_bits(folder.path(), &policy, "");
        assert_eq!(compiles, !far, "{origin:?}: {said}");
        assert!(
            !far || said.contains("define XCSCR_POSES_FROM_CORNER"),
            "{said}"
        );
        let (compiles, said) =
            compile_for_32_bits(folder.path(), &policy, "-DXCSCR_POSES_FROM_CORNER");
        assert!(compiles, "{said}");
        let is_clear = |at: &Point2<f64>| {
            let around = [[0.0, 0.01], [0.0, -0.01], [0.01, 0.0], [-0.01, 0.0]];
            let cells = around.map(|[x, y]| plain.cell_at(Point2::new(at.x + x, at.y + y)));
            cells.iter().all(|cell| *cell == plain.cell_at(*at))
        };
        let points: Vec<Point2<f64>> = points(&maze).into_iter().filter(is_clear).collect();
        let mut asked = String::new();
        for &at in &points {
            let [x, y] = in_map([0.0, 0.0, origin[2]], at);
            asked += &format!("{x} {y}\n");
        }
        let found = fed(
            &mut Command::new(folder.path().join("main")),
            asked.into_bytes(),
        );
        let found = String::from_utf8(found).unwrap();
        let wanted = points.iter().map(|&at| match plain.cell_at(at) {
            Some(Cell { col, row }) => format!("{col} {row}"),
            None => "outside".to_owned(),
        });
        let wanted: Vec<String> = wanted.collect();
        assert_eq!(found.lines().collect::<Vec<_>>(), wanted, "{origin:?}");
    }
}

/// Every free cell of a maze whose percept differs from the simulator's, by the map.
fn differing(target: Target, policy: &str, maze: &Maze, sensor: Sensor) -> Vec<Cell> {
    let mut questions = Questions::about(maze);
    maze.free_cells().for_each(|cell| questions.of('m', cell));
    let answers = Program::new(target, policy).answers(&questions);
    assert_eq!(answers.len(), maze.free_cells().count());
    let differs = |(cell, answer): &(Cell, String)| {
        let wanted = sensor.perceive_at(maze, *cell).to_string();
        let (bits, rest) = answer.split_at(wanted.len().min(answer.len()));
        bits != wanted || rest.contains('1')
    };
    let cells = maze.free_cells().zip(answers).filter(differs);
    cells.map(|(cell, _)| cell).collect()
}

#[test]
fn the_percept_from_a_map_is_that_of_every_sensor_in_every_free_cell() {
    // The edges of Woods1 are joined, which sensors of a position do not show.
    let without_position = [Sensor::Neighbours, Sensor::Lidar];
    for (world, sensors) in [("maze6", Sensor::ALL), ("woods1", &without_position)] {
        let maze = maze(world);
        for &sensor in sensors {
            for target in LANGUAGES {
                let policy = exported(target, &maze, sensor, ArenaKind::Grid);
                let cells = differing(target, &policy, &maze, sensor);
                assert_eq!(cells, [], "{world}, {}, {}", sensor.name(), target.name());
            }
        }
    }
}

#[test]
fn the_percept_from_the_walls_around_is_that_of_a_lidar_in_every_free_cell() {
    let maze = maze("maze6");
    let walls = |cell: Cell| {
        let seen = (0..).zip(Direction::CLOCKWISE).map(|(at, direction)| {
            let (east, south) = direction.offset();
            let there = Cell {
                col: (i32::from(cell.col) + east) as u16,
                row: (i32::from(cell.row) + south) as u16,
            };
            u64::from(maze.is_wall(there)) << at
        });
        seen.sum::<u64>()
    };
    let mut questions = Questions::default();
    for cell in maze.free_cells() {
        let place = [cell.col, cell.row].map(u64::from);
        questions.ask('w', &[place[0], place[1], walls(cell)]);
    }
    for sensor in [Sensor::Lidar, Sensor::LidarPosition] {
        for target in LANGUAGES {
            let policy = exported(target, &maze, sensor, ArenaKind::Grid);
            let answers = Program::new(target, &policy).answers(&questions);
            for (cell, answer) in maze.free_cells().zip(answers) {
                let wanted = sensor.perceive_at(&maze, cell).to_string();
                assert_eq!(answer[..wanted.len()], wanted, "{target:?} {cell:?}");
            }
        }
    }
}

#[test]
fn control_the_percept_of_another_sensor_or_a_map_without_joined_edges_differs() {
    let c_differs = |policy: &str, maze: &Maze, sensor| {
        let cells = differing(Target::C99, policy, maze, sensor);
        !cells.is_empty()
    };
    let [maze, joined] = ["maze4", "woods1"].map(maze);
    let exported = |maze| exported(Target::C99, maze, Sensor::Neighbours, ArenaKind::Grid);
    assert!(c_differs(&exported(&maze), &maze, Sensor::Lidar));
    let apart = exported(&joined).replace("#define XCSCR_WRAPS 1", "#define XCSCR_WRAPS 0");
    assert!(c_differs(&apart, &joined, Sensor::Neighbours));
}

#[test]
fn the_figures_of_the_robot_are_there_in_physics_and_left_out_on_the_grid() {
    let maze = placed(ORIGINS[2]);
    for target in LANGUAGES {
        let text = |arena| exported(target, &maze, Sensor::Lidar, arena);
        let (physics, grid) = (text(ArenaKind::Physics), text(ArenaKind::Grid));
        for figure in "ROBOT_RADIUS_M WHEEL_BASE_M MAX_SPEED_MPS MAX_TURN_RADPS".split(' ') {
            let name = format!("{} {figure}", target.name());
            assert!(physics.contains(figure) && !grid.contains(figure), "{name}");
        }
    }
    let text = exported(Target::C99, &maze, Sensor::Lidar, ArenaKind::Physics);
    for line in [
        "CELL_SIZE_M 0.25 /* edge of a cell, m */",
        "COLUMNS 8 ",
        "ROWS 5 ",
        "ORIGIN_X_M 3.25 ",
        "ORIGIN_Y_M (-1.5) ",
        "ROBOT_RADIUS_M 0.3 /* radius of the robot, m */",
        "WHEEL_BASE_M 0.4 ",
        "MAX_SPEED_MPS 1.4 ",
        "MAX_TURN_RADPS 12.0 ",
    ] {
        assert!(text.contains(&format!("#define XCSCR_{line}")), "{line}");
    }
}

#[test]
fn a_program_that_only_decides_holds_nothing_of_cells_poses_and_percepts() {
    let folder = tempfile::tempdir().unwrap();
    let maze = placed(ORIGINS[2]);
    let policy = exported(Target::C99, &maze, Sensor::Lidar, ArenaKind::Physics);
    fs::write(folder.path().join("policy.h"), policy).unwrap();
    let holds = |body: &str| {
        let text = format!("#include \"policy.h\"\nint main(void) {{ {body} }}\n");
        fs::write(folder.path().join("main.c"), text).unwrap();
        let mut compiler = Command::new("cc");
        compiler.args("-std=c99 -O0 -c main.c -o main.o".split(' '));
        fed(compiler.current_dir(folder.path()), Vec::new());
        let object = fs::read(folder.path().join("main.o")).unwrap();
        [
            "decide",
            "floor",
            "cell_from_pose",
            "percept_from_map",
            "percept_from_walls",
        ]
        .map(|name| {
            let name = format!("xcscr_{name}").into_bytes();
            object.windows(name.len()).any(|bytes| bytes == name)
        })
    };
    let decides = "const uint8_t percept[XCSCR_PERCEPT_BYTES] = {0}; return xcscr_decide(percept);";
    assert_eq!(holds(decides), [true, false, false, false, false]);
    let looks = "uint16_t column, row; return xcscr_cell_from_pose(0.0, 0.0, &column, &row);";
    assert_eq!(holds(looks), [false, true, true, false, false], "control");
}

#[test]
fn the_example_in_the_documentation_compiles_and_goes_from_a_pose_to_an_action() {
    let root = env!("CARGO_MANIFEST_DIR");
    let page = fs::read_to_string(format!("{root}/docs/src/reference/formats.md")).unwrap();
    let blocks = page.split("```c\n").skip(1);
    let blocks = blocks.map(|rest| rest.split("```").next().unwrap());
    let examples: Vec<&str> = blocks.filter(|block| block.contains("policy.h")).collect();
    assert_eq!(examples.len(), 2, "one by a map, one by walls");
    let maze = maze("maze4");
    for (example, call) in examples.into_iter().zip([
        "return action_at(1.5, 1.5) == 0 && action_at(-1.5, 1.5) == XCSCR_NO_ACTION",
        "return action_at(1.5, 1.5, 0xff) == 0 && action_at(-1.5, 1.5, 0xff) == XCSCR_NO_ACTION",
    ]) {
        let folder = tempfile::tempdir().unwrap();
        let policy = exported(Target::C99, &maze, Sensor::Lidar, ArenaKind::Physics);
        fs::write(folder.path().join("policy.h"), policy).unwrap();
        let main = format!("{example}\nint main(void) {{ {call} ? 0 : 1; }}\n");
        fs::write(folder.path().join("main.c"), main).unwrap();
        compile_c(folder.path(), "main.c");
        fed(&mut Command::new(folder.path().join("driver")), Vec::new());
    }
}
