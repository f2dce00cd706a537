//! Exported percepts in a world from a map: the open moves of the map, and walls that the robot sees.

use xcscr::agent::Method;
use xcscr::arena::ArenaKind;
use xcscr::export::Target;
use xcscr::sensor::Sensor;
use xcscr::trial::Plan;
use xcscr::world::{Cell, Direction, Maze};
use xcscr::xcs::Percept;

use super::program::{Program, Questions};
use super::text;
use crate::kit::flat::Flat;
use crate::learner::learned::learned;

/// The bit of the east, the third of eight cells.
const EAST: u64 = 1 << 2;

/// The questions about a cell: its percept, that of no number, and what a robot does that sees something in the east.
fn ask(questions: &mut Questions, maze: &Maze, cell: Cell) {
    let at = maze.centre_m(cell);
    questions.say('x', &[at.x, at.y]);
    questions.say('x', &[f64::NAN, at.y]);
    questions.ask('w', &[cell.col.into(), cell.row.into(), EAST]);
    questions.ask('o', &[cell.col.into(), cell.row.into(), EAST]);
}

fn shown(percept: &Percept) -> String {
    let bits = (0..percept.width()).map(|bit| if percept.bit(bit) { '1' } else { '0' });
    bits.collect()
}

#[test]
fn exported_percepts_are_those_of_the_map_and_of_walls_that_the_robot_sees() {
    let maze = Flat::new().gridded(0.5).maze;
    let mut questions = Questions::default();
    let cells = maze.free_cells();
    cells.for_each(|cell| ask(&mut questions, &maze, cell));
    for (target, sensor) in [
        (Target::C99, Sensor::LidarPosition),
        (Target::C99, Sensor::NeighboursPosition),
        (Target::Python, Sensor::LidarPosition),
        (Target::Python, Sensor::NeighboursPosition),
    ] {
        let plan = Plan::new(maze.clone()).method(Method::QLearning);
        let plan = plan.arena(ArenaKind::Grid).sensor(sensor).episodes(20);
        let learned = learned(plan);
        let answers = Program::new(target, &text(&learned, target)).answers(&questions);
        let width = sensor.width(&maze);
        for (cell, answers) in maze.free_cells().zip(answers.chunks(4)) {
            let expected = sensor.perceive_at(&maze, cell);
            // In these percepts the east is the third of eight cells, with two bits each.
            let mut blocked = shown(&expected);
            if sensor == Sensor::LidarPosition && maze.is_open(cell, Direction::East) {
                blocked.replace_range(4..6, "01");
            }
            let what = format!("{target:?} {sensor:?} {cell:?}");
            let [known, nowhere, scanned, open_actions] = answers else {
                panic!("{answers:?}");
            };
            assert_eq!(known[..width], shown(&expected), "{what}");
            assert_eq!(nowhere, "outside", "{what}");
            let is_open = |way: &Direction| maze.is_open(cell, *way) && *way != Direction::East;
            let open = (0..).zip(Direction::MAIN).filter(|(_, way)| is_open(way));
            let open: u32 = open.map(|(at, _)| 1 << at).sum();
            assert_eq!(*open_actions, open.to_string(), "{what}: open actions");
            if sensor == Sensor::LidarPosition {
                assert_eq!(scanned[..width], blocked, "{what}: with an obstacle");
            }
        }
        assert_eq!(answers.len(), 4 * maze.free_cells().count());
    }
}
