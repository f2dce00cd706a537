//! `/scene/maze`: floor, slippery cells, walls, start and goals.

use foxglove::messages::{CubePrimitive, LinePrimitive, SceneEntity, SceneUpdate, TextPrimitive};
use nalgebra::Point2;

use super::scene::{
    GRID, color, cube, entity, heading, lines, place, point, size_m, update, vector, words,
};
use xcscr_robot::world::{Block, Cell, Maze};

/// The colour of the floor.
const FLOOR: u32 = 0xeef1f5;
const FLOOR_LINE: u32 = 0xc3cad6;
const SLIPPERY: u32 = 0xcfe6f7;
const WALL: u32 = 0x57657f;
const START: u32 = 0xf4b740;
const GOAL: u32 = 0x35c46a;
const INK: u32 = 0x1d2430;
const NUMBER: u32 = 0xcfd8e8;
/// Mazes with more columns or rows than this have no numbers on their border.
const NUMBERED: u16 = 64;
/// Up to this many columns and rows, each of them is numbered. Larger mazes have fewer and larger
/// numbers, which are legible when the whole maze is in view.
const ALL_NUMBERED: u16 = 12;

/// The most blocks of a world from a map that are drawn.
const MOST_BLOCKS: usize = 1 << 14;

/// The height of letters and numbers, in cells, where every row and column is numbered.
const LETTER: f64 = 0.22;

/// Creates the scene of the maze. Very large mazes are drawn without walls.
pub(crate) fn scene(maze: &Maze, time_ns: u64) -> SceneUpdate {
    let mut ground = entity("floor", GRID, time_ns);
    ground.cubes = vec![floor(maze)];
    ground.cubes.extend(slippery(maze));
    ground.lines = vec![floor_lines(maze)];
    let mut walls = entity("walls", GRID, time_ns);
    if maze.is_from_map() {
        walls.cubes = true_walls(maze);
    } else if !maze.is_too_large() {
        walls.cubes = (0..maze.height())
            .flat_map(|row| blocks(maze, row))
            .collect();
    }
    walls.texts = numbers(maze);
    update(vec![ground, walls, tiles(maze, time_ns)])
}

/// Creates a slab whose top is at height 0.
fn floor(maze: &Maze) -> CubePrimitive {
    let unit = maze.cell_size_m();
    let [x, y] = size_m(maze);
    let thick = 0.02 * unit;
    cube(
        place(x / 2.0, y / 2.0, -thick / 2.0),
        vector(x, y, thick),
        color(FLOOR, 1.0),
    )
}

/// Returns the cells with unusual friction.
fn slippery(maze: &Maze) -> impl Iterator<Item = CubePrimitive> + '_ {
    let shown = (maze.has_floor() && !maze.is_too_large()).then(|| maze.free_cells());
    let unusual = shown.into_iter().flatten();
    let unusual = unusual.filter(|&cell| maze.friction(cell).is_some());
    unusual.map(|cell| {
        let (unit, at) = (maze.cell_size_m(), maze.centre_in_grid(cell));
        let size = vector(unit, unit, 0.004 * unit);
        cube(place(at.x, at.y, 0.001 * unit), size, color(SLIPPERY, 1.0))
    })
}

/// Returns the borders of the cells.
fn floor_lines(maze: &Maze) -> LinePrimitive {
    let unit = maze.cell_size_m();
    let [x, y] = size_m(maze);
    let along = |cells: u16| (1..cells).map(move |i| f64::from(i) * unit);
    let north = along(maze.width()).flat_map(|at| [Point2::new(at, 0.0), Point2::new(at, y)]);
    let east = along(maze.height()).flat_map(|at| [Point2::new(0.0, at), Point2::new(x, at)]);
    let points = north.chain(east).map(|at| point(at, 0.0)).collect();
    let pose = place(0.0, 0.0, 0.004 * unit);
    LinePrimitive {
        scale_invariant: true,
        ..lines(pose, 1.0, points, color(FLOOR_LINE, 1.0))
    }
}

/// Returns the walls of a world from a map in their true shape. Worlds with very many blocks are
/// drawn without walls.
fn true_walls(maze: &Maze) -> Vec<CubePrimitive> {
    let solid = maze.solid();
    let high = 0.25 * maze.cell_size_m();
    let block = |block: &Block| {
        let (at, [width, height]) = (solid.middle_of(block), solid.size_of(block));
        let mut pose = place(at.x, at.y, 0.5 * high);
        if let Some(corner) = solid.corner_in_grid() {
            pose.orientation = Some(heading(corner.rotation));
        }
        let size = vector(width, height, high);
        cube(pose, size, color(WALL, 1.0))
    };
    let blocks = solid.blocks();
    let shown = if blocks.len() > MOST_BLOCKS {
        &[]
    } else {
        &blocks[..]
    };
    shown.iter().map(block).collect()
}

/// Returns the walls of a row, a quarter of a cell high. Adjacent walls form one block.
fn blocks(maze: &Maze, row: u16) -> Vec<CubePrimitive> {
    let columns: Vec<u16> = (0..maze.width())
        .filter(|&col| maze.is_wall(Cell { col, row }))
        .collect();
    let segments = columns.chunk_by(|west, east| west + 1 == *east);
    segments.map(|segment| block(maze, row, segment)).collect()
}

fn block(maze: &Maze, row: u16, columns: &[u16]) -> CubePrimitive {
    let unit = maze.cell_size_m();
    let [west, east] =
        [columns[0], columns[columns.len() - 1]].map(|col| maze.centre_in_grid(Cell { col, row }));
    cube(
        place((west.x + east.x) / 2.0, west.y, 0.125 * unit),
        vector(columns.len() as f64 * unit, unit, 0.25 * unit),
        color(WALL, 1.0),
    )
}

/// Creates the labelled tiles of the start and the goals.
fn tiles(maze: &Maze, time_ns: u64) -> SceneEntity {
    let mut tiles = entity("tiles", GRID, time_ns);
    let start = maze.start().map(|cell| (cell, START, "START"));
    let goals = maze.goals().iter().map(|&cell| (cell, GOAL, "GOAL"));
    for (cell, rgb, name) in start.into_iter().chain(goals) {
        let (unit, at) = (maze.cell_size_m(), maze.centre_in_grid(cell));
        let size = vector(0.9375 * unit, 0.9375 * unit, 0.012 * unit);
        tiles
            .cubes
            .push(cube(place(at.x, at.y, 0.006 * unit), size, color(rgb, 1.0)));
        let north = place(at.x, at.y + 0.3125 * unit, 0.02 * unit);
        let letter = LETTER * enlargement(maze) * unit;
        tiles.texts.push(words(north, letter, INK, name));
    }
    tiles
}

/// Returns the factor by which letters are enlarged in a large maze, so that they are legible when
/// the whole maze is in view.
fn enlargement(maze: &Maze) -> f64 {
    let longest = maze.width().max(maze.height());
    (f64::from(longest) / f64::from(ALL_NUMBERED)).max(1.0)
}

/// Creates the numbers of columns and rows, on the walls along the northern and western border.
fn numbers(maze: &Maze) -> Vec<TextPrimitive> {
    let longest = maze.width().max(maze.height());
    if longest > NUMBERED {
        return Vec::new();
    }
    let unit = maze.cell_size_m();
    let enlargement = enlargement(maze);
    // The spacing follows the enlargement: every column, every second, every fifth, or every tenth.
    let interval = [1, 2, 5, 10].into_iter().find(|&n| n as f64 >= enlargement);
    let interval: usize = interval.unwrap_or(10);
    let north = (0..maze.width()).map(|col| (Cell { col, row: 0 }, col));
    let west = (0..maze.height()).map(|row| (Cell { col: 0, row }, row));
    let (north, west) = (north.step_by(interval), west.step_by(interval).skip(1));
    north
        .chain(west)
        .filter(|&(cell, _)| maze.is_wall(cell))
        .map(|(cell, number)| {
            let at = maze.centre_in_grid(cell);
            let top = place(at.x, at.y, 0.26 * unit);
            words(
                top,
                LETTER * enlargement * unit,
                NUMBER,
                &number.to_string(),
            )
        })
        .collect()
}
