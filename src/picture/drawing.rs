//! Draws a picture of a policy.

use std::collections::BTreeSet;

use super::colours::{css, shade};
use super::policy_picture::{Moment, PolicyPicture};
use super::svg::{Drawing, Element, SCALE, decimals, short};
use crate::record::colours::NO_GOAL;
use crate::world::{Cell, Direction, Maze};

pub(crate) const PAPER: u32 = 0xffffff;
pub(super) const INK: u32 = 0x1d2430;
pub(super) const FAINT: u32 = 0x5d6675;
pub(super) const GRID: u32 = 0xd9dee6;
pub(super) const WALL: u32 = 0x3d4757;
pub(super) const VISITED: u32 = 0xd3d8e0;
/// The floor beside the cells of a map.
pub(super) const FLOOR: u32 = 0xeef1f5;
const SLIPPERY: u32 = 0xe0f0fb;
/// Pale, so that arrows far from the goal are visible on it.
const START: u32 = 0xfdf0cf;
const GOAL: u32 = 0x7fdca0;
const PATH: u32 = 0x9cc3f5;
/// The colour of all actions that are not best.
const NONE: u32 = 0xb9c0cc;

/// The outline of an arrow of length 1 that points east, with its tail at the origin.
pub(super) const ARROW: &str = "<path id=\"a\" \
    d=\"M0 -0.07L0.58 -0.07L0.58 -0.24L1 0L0.58 0.24L0.58 0.07L0 0.07z\"/>";

/// Margin around the picture, in pixels.
pub(super) const MARGIN: f64 = 16.0;
/// Height of the title and caption above the maze.
pub(super) const HEAD: f64 = 62.0;
/// Height of the legend below the maze.
const FOOT: f64 = 90.0;
/// Least width that fits the text.
const LEAST_WIDTH: f64 = 544.0;
/// Least width of the picture of a world.
const LEAST_WORLD_WIDTH: f64 = 360.0;
/// Edge of a cell. It is smaller in mazes that would exceed [`MOST`].
const CELL: f64 = 64.0;
const MOST: f64 = 1280.0;

/// Positions of the cells in the picture.
pub(super) struct Plane<'a> {
    pub maze: &'a Maze,
    /// Edge of a cell, in pixels.
    pub cell: f64,
    /// The left edge of the maze, in pixels.
    pub left: f64,
}

/// Draws a picture of a policy.
pub(super) fn draw(picture: &PolicyPicture) -> Drawing {
    let maze = &picture.maze;
    let cell = cell_px(maze, 1);
    let maze_px = f64::from(maze.width()) * cell;
    let width = (maze_px + 2.0 * MARGIN).max(LEAST_WIDTH);
    let height = HEAD + f64::from(maze.height()) * cell + FOOT;
    let left = ((width - maze_px) / 2.0).floor();
    let plane = Plane { maze, cell, left };
    let moment = &picture.moments[0];
    let mut elements = vec![block(0.0, 0.0, width, height, PAPER)];
    elements.extend(plane.ground());
    elements.extend(plane.episode(moment));
    elements.push(words(MARGIN, 26.0, 17.0, INK, &picture.title));
    let caption = moment.caption(maze, &picture.paths);
    elements.push(words(MARGIN, 46.0, 13.0, FAINT, caption));
    elements.extend(legend(height - FOOT));
    Drawing {
        width: width as u32,
        height: height as u32,
        title: picture.title.clone(),
        definitions: ARROW,
        elements,
    }
}

/// Draws a world with its shortest paths.
pub(super) fn draw_world(maze: &Maze, caption: String) -> Drawing {
    let cell = cell_px(maze, 1);
    let [wide, high] = [maze.width(), maze.height()].map(|cells| f64::from(cells) * cell);
    let width = (wide + 2.0 * MARGIN).max(LEAST_WORLD_WIDTH);
    let height = HEAD + high + MARGIN;
    let left = ((width - wide) / 2.0).floor();
    let plane = Plane { maze, cell, left };
    let mut elements = vec![block(0.0, 0.0, width, height, PAPER)];
    elements.extend(plane.ground());
    elements.extend(plane.cells(&[]));
    elements.extend(plane.optimal_paths());
    elements.extend(plane.letters());
    elements.push(words(MARGIN, 26.0, 17.0, INK, maze.name()));
    elements.push(words(MARGIN, 46.0, 13.0, FAINT, caption));
    Drawing {
        width: width as u32,
        height: height as u32,
        title: maze.name().to_owned(),
        definitions: ARROW,
        elements,
    }
}

/// Returns the edge of a cell, in pixels, for pictures of `panels` mazes side by side.
pub(super) fn cell_px(maze: &Maze, panels: usize) -> f64 {
    let (cols, rows) = (usize::from(maze.width()), usize::from(maze.height()));
    let most = MOST / (cols * panels).max(rows) as f64;
    most.floor().clamp(3.0, CELL)
}

impl Plane<'_> {
    pub fn corner(&self, cell: Cell) -> (f64, f64) {
        (
            self.left + f64::from(cell.col) * self.cell,
            HEAD + f64::from(cell.row) * self.cell,
        )
    }

    pub fn centre(&self, cell: Cell) -> (f64, f64) {
        let (left, top) = self.corner(cell);
        (left + self.cell / 2.0, top + self.cell / 2.0)
    }

    /// Returns the square of a cell, smaller by `inset` on each side.
    pub fn tile(&self, cell: Cell, inset: f64, fill: u32) -> Element {
        let (left, top) = self.corner(cell);
        let edge = self.cell - 2.0 * inset;
        block(left + inset, top + inset, edge, edge, fill)
    }

    /// Returns walls and floor.
    pub fn ground(&self) -> Vec<Element> {
        let maze = self.maze;
        let (cols, rows) = (f64::from(maze.width()), f64::from(maze.height()));
        let (wide, high) = (cols * self.cell, rows * self.cell);
        let mut shapes = vec![block(self.left, HEAD, wide, high, WALL)];
        if maze.is_from_map() {
            shapes.extend(self.raster());
        }
        let cells = maze.free_cells();
        shapes.extend(cells.map(|cell| self.tile(cell, 0.0, GRID)));
        shapes
    }

    /// Returns visited cells, path and arrows, and the letters of marked cells.
    fn episode(&self, frame: &Moment) -> Vec<Element> {
        let mut shapes = self.cells(&frame.visited);
        let path = frame.greedy_path.iter().map(|&cell| self.centre(cell));
        shapes.push(path_line(&path.collect::<Vec<_>>(), 0.12 * self.cell));
        shapes.extend(self.arrows(frame));
        shapes.extend(self.letters());
        shapes
    }

    /// Returns the cells, the marked ones in their colours, and walls in their true shape.
    fn cells(&self, visited: &[Cell]) -> Vec<Element> {
        let mut shapes = Vec::new();
        let visited = visited.iter().map(|&cell| self.maze.index(cell));
        let visited: BTreeSet<usize> = visited.collect();
        for cell in self.maze.free_cells() {
            let was_here = visited.contains(&self.maze.index(cell));
            let fill = match () {
                () if was_here => VISITED,
                () if self.maze.friction(cell).is_some() => SLIPPERY,
                () => PAPER,
            };
            shapes.push(self.tile(cell, 0.5, fill));
        }
        let tile = |(cell, fill, _)| self.tile(cell, 0.06 * self.cell, fill);
        shapes.extend(self.marked().map(tile));
        shapes.extend(self.true_walls());
        shapes
    }

    /// Returns an arrow for each action in each free cell. Arrows of best actions are long and
    /// coloured by the distance to the goal along the policy. The others are short and faint.
    fn arrows(&self, frame: &Moment) -> Vec<Element> {
        let mut shapes = Vec::new();
        let near = frame.policy.nearness(self.maze);
        for ((cell, values), near) in frame.policy.cells().zip(near) {
            let directions = self.maze.moves().directions().iter();
            for (&direction, &one) in directions.zip(values.as_slice()) {
                let is_best = one.is_some() && one == values.greatest();
                let (length, fill) = match (one, is_best) {
                    (None, _) => (0.0, NONE),
                    (Some(_), true) => (0.47, near.map_or(NO_GOAL, shade)),
                    (Some(_), false) => (0.2, NONE),
                };
                let tail = self.centre(*cell);
                shapes.push(arrow(tail, direction, length * self.cell, fill));
            }
        }
        shapes
    }

    /// Returns the start and the goals, each with its colour and its letter.
    fn marked(&self) -> impl Iterator<Item = (Cell, u32, &'static str)> {
        let start = self.maze.start().map(|cell| (cell, START, "S"));
        let goals = self.maze.goals().iter().map(|&cell| (cell, GOAL, "G"));
        start.into_iter().chain(goals)
    }

    /// Returns the letters of marked cells.
    pub fn letters(&self) -> impl Iterator<Item = Element> {
        self.marked().map(|(cell, _, text)| {
            let (left, top) = self.corner(cell);
            let size = 0.24 * self.cell;
            words(left + 0.1 * self.cell, top + 1.25 * size, size, INK, text)
        })
    }
}

fn legend(top: f64) -> Vec<Element> {
    let first = top + 26.0;
    let second = first + 24.0;
    let sample =
        |x: f64, y: f64, share: f64| arrow((x, y - 4.5), Direction::East, 26.0, shade(share));
    let says = |x: f64, y: f64, text: &str| words(x, y, 12.0, INK, text);
    let path = vec![(288.0, first - 4.5), (308.0, first - 4.5)];
    vec![
        sample(MARGIN, first, 1.0),
        says(50.0, first, "near the goal"),
        sample(152.0, first, 0.0),
        says(186.0, first, "far from it"),
        path_line(&path, 7.0),
        says(320.0, first, "greedy path: the best actions"),
        block(MARGIN + 4.0, second - 13.0, 17.0, 17.0, VISITED),
        says(50.0, second, "visited in this episode"),
        says(226.0, second, "long: best action; grey: leads to no goal"),
    ]
}

pub(crate) fn block(left: f64, top: f64, width: f64, height: f64, fill: u32) -> Element {
    let lengths = [left, top, width, height].map(short);
    let [x, y, width, height] = lengths;
    let attributes = [
        ("x", x),
        ("y", y),
        ("width", width),
        ("height", height),
        ("fill", css(fill)),
    ];
    Element::new("rect", attributes)
}

/// Draws a path through points.
fn path_line(points: &[(f64, f64)], width: f64) -> Element {
    let points = points
        .iter()
        .map(|(x, y)| format!("{},{}", short(*x), short(*y)));
    let attributes = [
        ("points", points.collect::<Vec<_>>().join(" ")),
        ("fill", "none".to_owned()),
        ("stroke", css(PATH)),
        ("stroke-width", short(width)),
        ("stroke-linecap", "round".to_owned()),
        ("stroke-linejoin", "round".to_owned()),
    ];
    Element::new("polyline", attributes)
}

/// Draws an arrow. An arrow of length 0 is invisible.
pub(super) fn arrow((x, y): (f64, f64), direction: Direction, length: f64, fill: u32) -> Element {
    let eighths = Direction::CLOCKWISE
        .iter()
        .position(|&one| one == direction);
    let degrees = 45 * eighths.unwrap_or(0) as i32 - 90;
    let attributes = [
        ("href", "#a".to_owned()),
        (SCALE, decimals(length, 1)),
        ("fill", css(fill)),
    ];
    let place = format!("translate({} {})rotate({degrees})", short(x), short(y));
    Element::new("use", attributes).in_group(place)
}

/// Writes text that begins at a point on its baseline.
pub(super) fn words(x: f64, y: f64, size: f64, colour: u32, text: impl Into<String>) -> Element {
    let attributes = [
        ("x", short(x)),
        ("y", short(y)),
        ("font-size", short(size)),
        ("fill", css(colour)),
    ];
    Element::new("text", attributes).with_text(text)
}
