//! The maze: cells, walls, start and goal.

use std::sync::Arc;

use nalgebra::{Isometry2, Matrix3, Point2, Vector2};
use serde::{Deserialize, Serialize};

use super::cache::Cache;
use super::direction::{Direction, Moves};
use super::name;
use super::origin::Origin;
use super::solid::Solid;
use xcs::Action;

/// The largest maze, in cells, that is shown cell by cell: larger ones are not drawn, and neither
/// their walls nor the values of their cells are recorded.
const MOST_SHOWN: usize = 1 << 14;

/// A cell of the maze; row 0 is the northern border, column 0 the western one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Cell {
    /// The column, counted from the west.
    pub col: u16,
    /// The row, counted from the north.
    pub row: u16,
}

/// The friction of each cell's floor in tenths, in reading order; 0 for the usual floor. `None` if
/// the whole floor is usual.
pub(super) type Floor = Option<Arc<[u8]>>;

/// A checked maze: its border is closed (or joined), and every start can reach a goal.
///
/// Public methods take and return metres of the map frame. For a world made from a ROS map this is
/// the frame of that map. Otherwise its origin is in the south-western corner of the border, x to
/// the east, y to the north. A clone shares the cells with its original.
#[derive(Debug, Clone, PartialEq)]
pub struct Maze {
    pub(super) name: String,
    pub(super) cell_size_m: f64,
    pub(super) moves: Moves,
    pub(super) wrap: bool,
    pub(super) origin: Origin,
    pub(super) width: u16,
    pub(super) height: u16,
    /// Row by row from the north: true for walls.
    pub(super) walls: Arc<[bool]>,
    /// The true shape of the walls: in a maze the cells themselves.
    pub(super) solid: Arc<Solid>,
    /// The walls and the obstacles that the robot's map does not have; `None` without obstacles.
    pub(super) obstructed: Option<Arc<Solid>>,
    /// In a world from a map: one bit for each direction, clockwise from north, set if the move is
    /// clear of walls. `None` in a maze.
    pub(super) open: Option<Arc<[u8]>>,
    pub(super) start: Option<Cell>,
    /// In reading order; never empty.
    pub(super) goals: Vec<Cell>,
    pub(super) floor: Floor,
    pub(super) cache: Cache,
}

impl Maze {
    /// Returns the world's name from its file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the edge length of a cell in metres.
    pub fn cell_size_m(&self) -> f64 {
        self.cell_size_m
    }

    /// Returns the directions of the moves.
    pub fn moves(&self) -> Moves {
        self.moves
    }

    /// Returns true if the edges join, so that leaving in the east enters in the west.
    pub fn wraps(&self) -> bool {
        self.wrap
    }

    /// Returns the pose of the south-western corner of the grid in the map frame. Worlds without
    /// `origin` have the default.
    pub fn origin(&self) -> Origin {
        self.origin
    }

    /// Returns the number of columns.
    pub fn width(&self) -> u16 {
        self.width
    }

    /// Returns the number of rows.
    pub fn height(&self) -> u16 {
        self.height
    }

    /// Returns the start cell; `None` if each episode starts in a random free cell.
    pub fn start(&self) -> Option<Cell> {
        self.start
    }

    /// Returns the goal cells in reading order; at least one.
    pub fn goals(&self) -> &[Cell] {
        &self.goals
    }

    /// Returns the number of actions.
    pub fn action_count(&self) -> usize {
        self.moves.directions().len()
    }

    /// Returns the direction of an action; `None` if this world has fewer moves.
    pub fn direction(&self, action: Action) -> Option<Direction> {
        self.moves.directions().get(action.index()).copied()
    }

    /// Returns the valid world name nearest to a text.
    pub fn repaired_name(text: &str) -> String {
        name::repaired(text)
    }

    /// Returns the name of the direction of an action, or its number if this world has fewer moves.
    pub fn action_name(&self, action: Action) -> String {
        match self.direction(action) {
            Some(direction) => direction.name().to_owned(),
            None => format!("action {}", action.index()),
        }
    }

    /// Returns true if the cell is a wall or outside the maze.
    pub fn is_wall(&self, cell: Cell) -> bool {
        cell.col >= self.width || cell.row >= self.height || self.walls[self.index(cell)]
    }

    /// Returns the true shape of the walls.
    pub fn solid(&self) -> &Arc<Solid> {
        &self.solid
    }

    /// Returns true if the walls have another shape than the cells, as in worlds from a map.
    pub fn is_from_map(&self) -> bool {
        self.open.is_some()
    }

    /// Returns true if the cell is a goal.
    pub fn is_goal(&self, cell: Cell) -> bool {
        let place = |cell: &Cell| (cell.row, cell.col);
        self.goals
            .binary_search_by_key(&place(&cell), place)
            .is_ok()
    }

    /// Returns all free cells in reading order.
    pub fn free_cells(&self) -> impl Iterator<Item = Cell> + '_ {
        self.cells().filter(|&cell| !self.is_wall(cell))
    }

    /// Returns the cells in which an episode can start, in reading order: the start cell, or all
    /// free cells except the goals.
    pub fn start_cells(&self) -> Vec<Cell> {
        self.starts().collect()
    }

    /// Returns the same cells as an iterator, for large mazes.
    pub fn starts(&self) -> impl DoubleEndedIterator<Item = Cell> + '_ {
        let anywhere = self.start.is_none().then(|| self.cells());
        let anywhere = anywhere.into_iter().flatten();
        let free = anywhere.filter(|&cell| !self.is_wall(cell) && !self.is_goal(cell));
        self.start.into_iter().chain(free)
    }

    /// Returns true if the maze is too large to show every cell.
    pub fn is_too_large(&self) -> bool {
        self.walls.len() > MOST_SHOWN
    }

    /// Returns all cells in reading order.
    pub fn cells(&self) -> impl DoubleEndedIterator<Item = Cell> + use<> {
        let (width, height) = (self.width, self.height);
        (0..height).flat_map(move |row| (0..width).map(move |col| Cell { col, row }))
    }

    /// Returns the index of a cell in reading order.
    pub fn index(&self, cell: Cell) -> usize {
        usize::from(cell.row) * usize::from(self.width) + usize::from(cell.col)
    }

    /// Returns the next cell in a direction, wall or not; `None` beyond a border that does not
    /// join.
    pub fn neighbour(&self, cell: Cell, direction: Direction) -> Option<Cell> {
        let (east, south) = direction.offset();
        let along = |from: u16, step: i32, size: u16| match from.checked_add_signed(step as i16) {
            Some(to) if to < size => Some(to),
            _ if self.wrap => Some(if step < 0 { size - 1 } else { 0 }),
            _ => None,
        };
        Some(Cell {
            col: along(cell.col, east, self.width)?,
            row: along(cell.row, south, self.height)?,
        })
    }

    /// Returns the cell that a move leads to; `None` if a wall or the border bars it.
    pub fn step(&self, cell: Cell, direction: Direction) -> Option<Cell> {
        self.neighbour(cell, direction)
            .filter(|&next| !self.is_wall(next) && !self.is_barred(cell, direction))
    }

    /// Returns a number about this maze that is expensive to compute. It is computed once for a
    /// maze and its clones.
    pub fn once(&self, figure: &'static str, find: impl FnOnce() -> Option<f64>) -> Option<f64> {
        self.cache.figure(figure, find)
    }

    /// Returns the middle of a cell in the map frame, in metres.
    pub fn centre_m(&self, cell: Cell) -> Point2<f64> {
        self.point_in_map(self.centre_in_grid(cell))
    }

    /// Returns the cell that contains a point of the map frame, in metres; `None` outside the maze.
    pub fn cell_at(&self, point_m: Point2<f64>) -> Option<Cell> {
        self.cell_in_grid(self.point_in_grid(point_m))
    }
}

impl Maze {
    /// Returns the geometry of walls that fill their cells.
    pub(super) fn solid_cells(walls: &Arc<[bool]>, width: u16, cell_size_m: f64) -> Arc<Solid> {
        let width = usize::from(width);
        let corner = Origin::default();
        Arc::new(Solid::new(width, Arc::clone(walls), cell_size_m, corner))
    }
}

/// The grid frame, in which the walls are simulated and drawn: origin in the south-western corner
/// of the border, x to the east, y to the north, in metres. Without an `origin` it is exactly the
/// map frame.
impl Maze {
    /// Returns the middle of a cell in the grid frame.
    pub fn centre_in_grid(&self, cell: Cell) -> Point2<f64> {
        Point2::new(
            (f64::from(cell.col) + 0.5) * self.cell_size_m,
            (f64::from(self.height) - f64::from(cell.row) - 0.5) * self.cell_size_m,
        )
    }

    /// Returns the cell that contains a point of the grid frame; `None` outside the maze.
    pub fn cell_in_grid(&self, point_m: Point2<f64>) -> Option<Cell> {
        let col = (point_m.x / self.cell_size_m).floor();
        let row = f64::from(self.height) - 1.0 - (point_m.y / self.cell_size_m).floor();
        let inside = (0.0..f64::from(self.width)).contains(&col)
            && (0.0..f64::from(self.height)).contains(&row);
        inside.then_some(Cell {
            col: col as u16,
            row: row as u16,
        })
    }

    /// Returns the pose of the grid frame in the map frame; `None` if they are the same.
    pub fn grid_in_map(&self) -> Option<Isometry2<f64>> {
        (self.origin != Origin::default()).then(|| self.origin.pose())
    }

    /// Converts a point from the grid frame to the map frame.
    pub fn point_in_map(&self, point_in_grid: Point2<f64>) -> Point2<f64> {
        self.grid_in_map()
            .map_or(point_in_grid, |grid| grid * point_in_grid)
    }

    /// Converts a point from the map frame to the grid frame.
    pub fn point_in_grid(&self, point_in_map: Point2<f64>) -> Point2<f64> {
        let grid = self.grid_in_map();
        grid.map_or(point_in_map, |grid| {
            grid.inverse_transform_point(&point_in_map)
        })
    }

    /// Converts a direction from the grid frame to the map frame.
    pub fn vector_in_map(&self, vector_in_grid: Vector2<f64>) -> Vector2<f64> {
        self.grid_in_map()
            .map_or(vector_in_grid, |grid| grid * vector_in_grid)
    }

    /// Converts a covariance of x, y and heading from the grid frame to the map frame.
    pub fn covariance_in_map(&self, covariance_in_grid: Matrix3<f64>) -> Matrix3<f64> {
        self.grid_in_map().map_or(covariance_in_grid, |grid| {
            let turn = grid.rotation.to_rotation_matrix().into_inner();
            let turn = turn.to_homogeneous();
            turn * covariance_in_grid * turn.transpose()
        })
    }

    /// Converts a pose from the grid frame to the map frame.
    pub fn pose_in_map(&self, pose_in_grid: Isometry2<f64>) -> Isometry2<f64> {
        self.grid_in_map()
            .map_or(pose_in_grid, |grid| grid * pose_in_grid)
    }
}

impl Maze {
    /// Returns the friction between wheels and the floor of a cell. Returns `None` for the usual
    /// floor, whose friction is a setting of the robot.
    pub fn friction(&self, cell: Cell) -> Option<f64> {
        let floor = self.floor.as_ref()?;
        let inside = cell.col < self.width && cell.row < self.height;
        let tenths = floor[if inside { self.index(cell) } else { 0 }];
        (inside && tenths > 0).then(|| f64::from(tenths) / 10.0)
    }

    /// Returns the same maze with one friction on all free cells, in tenths (1 to 9; 0 is the usual
    /// floor).
    #[must_use]
    pub fn with_friction(&self, tenths: u8) -> Self {
        let of_cell = |&wall: &bool| if wall { 0 } else { tenths };
        let floor = (tenths > 0).then(|| self.walls.iter().map(of_cell).collect());
        Self {
            floor,
            ..self.clone()
        }
    }

    /// Returns true if any cell has an unusual floor.
    pub fn has_floor(&self) -> bool {
        self.floor.is_some()
    }

    /// Returns the rows of the floor in the format of world files; `None` if the whole floor is
    /// usual.
    pub fn floor_rows(&self) -> Option<Vec<String>> {
        let letter = |(&tenths, &wall): (&u8, &bool)| match (tenths, wall) {
            (_, true) => '#',
            (0, false) => '.',
            (tenths, false) => char::from(b'0' + tenths),
        };
        let letters: Vec<char> = self
            .floor
            .as_ref()?
            .iter()
            .zip(&*self.walls)
            .map(letter)
            .collect();
        let rows = letters.chunks(usize::from(self.width));
        Some(rows.map(|row| row.iter().collect()).collect())
    }
}
