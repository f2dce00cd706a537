//! From a film to shapes.

use super::arrow::Heading;
use super::film::{Film, Moment};
use super::shapes::{Colour, Drawing, Shape};
use crate::world::{Cell, Direction, Maze, Paths};

const PAPER: Colour = Colour::hex(0xffffff);
const INK: Colour = Colour::hex(0x1d2430);
const FAINT: Colour = Colour::hex(0x5d6675);
const GRID: Colour = Colour::hex(0xd9dee6);
const WALL: Colour = Colour::hex(0x3d4757);
const VISITED: Colour = Colour::hex(0xd3d8e0);
const START: Colour = Colour::hex(0xf4b740);
const GOAL: Colour = Colour::hex(0x7fdca0);
const PATH: Colour = Colour::hex(0x43c878);
/// The colours of the least worth, of none and of the greatest: red, grey, blue.
const WORST: Colour = Colour::hex(0xd81f2a);
const NONE: Colour = Colour::hex(0xb9c0cc);
const BEST: Colour = Colour::hex(0x1554d1);

/// Around everything.
const MARGIN: f64 = 16.0;
/// Room for title and caption above the maze.
const HEAD: f64 = 62.0;
/// Room for the legend below the maze.
const FOOT: f64 = 66.0;
/// The least width, so that the words fit.
const LEAST_WIDTH: f64 = 544.0;
/// The edge of a cell; less in mazes that would become larger than [`MOST`].
const CELL: f64 = 64.0;
const MOST: f64 = 1280.0;

/// Where cells lie in the picture.
struct Plane<'a> {
    maze: &'a Maze,
    cell: f64,
    left: f64,
    width: f64,
    height: f64,
}

/// Draws all moments of a film.
pub(super) fn draw(film: &Film) -> Drawing {
    let plane = Plane::new(&film.maze);
    let paths = Paths::new(&film.maze);
    let frames = film.moments.iter();
    Drawing {
        width: plane.width as u32,
        height: plane.height as u32,
        title: film.title.clone(),
        ground: plane.ground(),
        frames: frames.map(|moment| plane.moment(moment, &paths)).collect(),
        labels: plane.labels(&film.title),
    }
}

impl<'a> Plane<'a> {
    fn new(maze: &'a Maze) -> Self {
        let (cols, rows) = (f64::from(maze.width()), f64::from(maze.height()));
        let cell = (MOST / cols.max(rows)).floor().clamp(3.0, CELL);
        let width = (cols * cell + 2.0 * MARGIN).max(LEAST_WIDTH);
        Self {
            maze,
            cell,
            left: ((width - cols * cell) / 2.0).floor(),
            width,
            height: HEAD + rows * cell + FOOT,
        }
    }

    fn corner(&self, cell: Cell) -> (f64, f64) {
        (
            self.left + f64::from(cell.col) * self.cell,
            HEAD + f64::from(cell.row) * self.cell,
        )
    }

    fn centre(&self, cell: Cell) -> (f64, f64) {
        let (left, top) = self.corner(cell);
        (left + self.cell / 2.0, top + self.cell / 2.0)
    }

    /// A cell's box, smaller on each side by `inset`.
    fn tile(&self, cell: Cell, inset: f64, fill: Colour) -> Shape {
        let (left, top) = self.corner(cell);
        let edge = self.cell - 2.0 * inset;
        block(left + inset, top + inset, edge, edge, fill)
    }

    /// Paper, floor and walls.
    fn ground(&self) -> Vec<Shape> {
        let maze = self.maze;
        let mut shapes = vec![block(0.0, 0.0, self.width, self.height, PAPER)];
        let (cols, rows) = (f64::from(maze.width()), f64::from(maze.height()));
        let (wide, high) = (cols * self.cell, rows * self.cell);
        shapes.push(block(self.left, HEAD, wide, high, WALL));
        let cells = maze.free_cells();
        shapes.extend(cells.map(|cell| self.tile(cell, 0.0, GRID)));
        shapes
    }

    /// What changes from moment to moment: cells visited, path, arrows, caption.
    fn moment(&self, moment: &Moment, paths: &Paths) -> Vec<Shape> {
        let mut shapes = Vec::new();
        for cell in self.maze.free_cells() {
            let was_here = moment.visited.contains(&cell);
            let fill = if was_here { VISITED } else { PAPER };
            shapes.push(self.tile(cell, 0.5, fill));
        }
        shapes.extend(self.marks());
        let from = moment.visited[0];
        let path = moment.policy.greedy_path(self.maze, from);
        shapes.push(Shape::Line {
            points: path.iter().map(|&cell| self.centre(cell)).collect(),
            width: 0.12 * self.cell,
            colour: PATH,
        });
        shapes.extend(self.arrows(moment));
        let caption = moment.caption(self.maze, paths.distance(self.maze, from));
        shapes.push(words(MARGIN, 46.0, 13.0, FAINT, caption));
        shapes
    }

    /// An arrow per action and free cell; length and colour grow with the root of the worth, so
    /// that what is far from the goal can be seen, too.
    fn arrows(&self, moment: &Moment) -> Vec<Shape> {
        let known = |(_, worth): &(Cell, xcs::PredictionArray)| {
            let all = worth.as_slice().iter().flatten();
            all.copied().map(f64::abs).fold(f64::MIN_POSITIVE, f64::max)
        };
        let most = moment.policy.cells().map(known);
        let most = most.fold(f64::MIN_POSITIVE, f64::max);
        let mut shapes = Vec::new();
        for (cell, worth) in moment.policy.cells() {
            let directions = self.maze.moves().directions().iter();
            for (&direction, worth) in directions.zip(worth.as_slice()) {
                let share = worth.map_or(0.0, |w| (w.abs() / most).sqrt().copysign(w));
                shapes.push(self.arrow(*cell, direction, share));
            }
        }
        shapes
    }

    fn arrow(&self, cell: Cell, direction: Direction, share: f64) -> Shape {
        Shape::Arrow {
            tail: self.centre(cell),
            heading: Heading::new(direction),
            length: match share.abs() {
                0.0 => 0.0,
                share => self.cell * (0.1 + 0.37 * share),
            },
            fill: shade(share),
        }
    }

    /// Start and goals.
    fn marks(&self) -> Vec<Shape> {
        let start = self.maze.start().map(|cell| (cell, START));
        let goals = self.maze.goals().iter().map(|&cell| (cell, GOAL));
        let marks = start.into_iter().chain(goals);
        marks
            .map(|(cell, fill)| self.tile(cell, 0.06 * self.cell, fill))
            .collect()
    }

    /// The letters of start and goals, title and legend.
    fn labels(&self, title: &str) -> Vec<Shape> {
        let start = self.maze.start().map(|cell| (cell, "S"));
        let goals = self.maze.goals().iter().map(|&cell| (cell, "G"));
        let letter = |(cell, text): (Cell, &str)| {
            let (left, top) = self.corner(cell);
            let size = 0.24 * self.cell;
            words(left + 0.1 * self.cell, top + 1.25 * size, size, INK, text)
        };
        let mut shapes: Vec<Shape> = start.into_iter().chain(goals).map(letter).collect();
        shapes.push(words(MARGIN, 26.0, 17.0, INK, title));
        shapes.extend(self.legend());
        shapes
    }

    fn legend(&self) -> Vec<Shape> {
        let first = self.height - FOOT + 26.0;
        let second = first + 24.0;
        let sample = |x: f64, y: f64, share: f64| Shape::Arrow {
            tail: (x, y - 4.5),
            heading: Heading::new(Direction::East),
            length: 26.0,
            fill: shade(share),
        };
        let says = |x: f64, y: f64, text: &str| words(x, y, 12.0, INK, text);
        let path = Shape::Line {
            points: vec![(288.0, first - 4.5), (308.0, first - 4.5)],
            width: 7.0,
            colour: PATH,
        };
        vec![
            sample(MARGIN, first, 1.0),
            says(50.0, first, "worth > 0"),
            sample(152.0, first, -1.0),
            says(186.0, first, "worth < 0"),
            path,
            says(320.0, first, "greedy path: the best actions"),
            block(MARGIN + 4.0, second - 13.0, 17.0, 17.0, VISITED),
            says(50.0, second, "visited in this episode"),
            says(226.0, second, "length and colour: the root of the worth"),
        ]
    }
}

fn block(left: f64, top: f64, width: f64, height: f64, fill: Colour) -> Shape {
    Shape::Rect {
        left,
        top,
        width,
        height,
        fill,
    }
}

fn words(x: f64, y: f64, size: f64, colour: Colour, text: impl Into<String>) -> Shape {
    Shape::Text {
        at: (x, y),
        size,
        colour,
        text: text.into(),
    }
}

/// The colour of a worth, from -1 to 1; the sign can always be told.
fn shade(share: f64) -> Colour {
    let strength = 0.3 + 0.7 * share.abs();
    NONE.toward(if share < 0.0 { WORST } else { BEST }, strength)
}
