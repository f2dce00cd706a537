//! The cells of an occupancy map, before conversion to a maze.

use std::collections::VecDeque;
use std::f64::consts::FRAC_PI_2;

use nalgebra::{Point2, Vector2};

use super::raster::Raster;
use super::{MapError, OccupancyMap};
use crate::world::rows::MAX_SIDE;
use crate::world::{Maze, Origin, Solid};

/// The tolerance for rounding when comparing lengths, as a share of a cell.
const ROUNDING: f64 = 1e-6;
/// The smallest and the largest edge of a cell, in metres, as in world files.
const CELL_M: std::ops::RangeInclusive<f64> = 0.1..=10.0;
/// The radius of the smallest robot, in metres, as in the settings.
const LEAST_RADIUS_M: f64 = 0.02;

/// The alignment of a grid with an image. All lengths are in metres, and the frame of the image has
/// its origin in the lower left corner.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    pub cols: usize,
    pub rows: usize,
    pub cell_m: f64,
    /// The pose of the lower left corner of the grid in the frame of the image.
    pub corner: Origin,
    /// The lower left corner of the grid, to the right and upward along the grid from the smallest
    /// grid that covers the image. Never positive.
    pub offset_m: [f64; 2],
}

/// The cells of an occupancy map, before conversion to a maze.
pub(super) struct Cells<'a> {
    raster: &'a Raster<'a>,
    solid: &'a Solid,
    pub layout: Layout,
    /// The radius of the disc that must stay clear.
    radius_m: f64,
    /// Row by row from the top.
    pub free: Vec<bool>,
}

/// The range of cells that becomes a maze, each axis as start and end. It may extend one cell
/// beyond the map.
#[derive(Debug, Clone, Copy)]
pub(super) struct Window {
    cols: [isize; 2],
    rows: [isize; 2],
}

impl Layout {
    /// Covers an image with cells whose rows are turned by `yaw_rad`.
    pub fn new(
        map: &OccupancyMap,
        cell_m: f64,
        yaw_rad: f64,
        offset_m: [f64; 2],
    ) -> Result<Self, MapError> {
        let fault = |fault: String| Err(MapError::Cell(fault));
        let pixel_m = map.resolution_m;
        if cell_m == pixel_m && !CELL_M.contains(&cell_m) {
            return fault(format!(
                "a pixel of {pixel_m} m cannot be a cell: give the edge of a cell in metres, such as `--cell 0.5`"
            ));
        }
        if !CELL_M.contains(&cell_m) {
            return fault(format!(
                "`--cell` is {cell_m} m, but must be from {} to {}",
                CELL_M.start(),
                CELL_M.end()
            ));
        }
        if cell_m / pixel_m < 1.0 - ROUNDING {
            return fault(format!(
                "a cell of {cell_m} m is smaller than a pixel of {pixel_m} m"
            ));
        }
        if !(-FRAC_PI_2..=FRAC_PI_2).contains(&yaw_rad) {
            return fault(format!(
                "`--rotate` is {} degrees, but must be from -90 to 90",
                yaw_rad.to_degrees()
            ));
        }
        // Shifting a grid by a whole number of cells does not change it.
        let offset_m = offset_m.map(|metres| 0.0 - (-metres).rem_euclid(cell_m));
        let [low, high] = extent(map, yaw_rad);
        let first = low + Vector2::from(offset_m);
        let count = |axis: usize| ((high[axis] - first[axis]) / cell_m - ROUNDING).ceil() as usize;
        let (cols, rows) = (count(0), count(1));
        if cols.max(rows) + 2 > MAX_SIDE {
            return fault(format!(
                "{cols} x {rows} cells of {cell_m} m are too many: a world has at most {MAX_SIDE} \
                 columns and rows; give a larger `--cell`"
            ));
        }
        let turned = Origin::from([0.0, 0.0, yaw_rad]);
        Ok(Self {
            cols,
            rows,
            cell_m,
            corner: turned.moved(first.into()),
            offset_m,
        })
    }

    /// Returns the middle of a cell in the frame of the image.
    pub fn middle(&self, at: usize) -> Point2<f64> {
        let (col, row) = (at % self.cols, at / self.cols);
        let [x, y] = [col as f64 + 0.5, (self.rows - row) as f64 - 0.5];
        self.corner
            .to_map(Point2::new(x * self.cell_m, y * self.cell_m))
    }
}

/// Returns the lowest and the highest coordinates of an image along a turned grid.
fn extent(map: &OccupancyMap, yaw_rad: f64) -> [Vector2<f64>; 2] {
    let grid = Origin::from([0.0, 0.0, yaw_rad]);
    let [width, height] = [map.width, map.height].map(|pixels| pixels as f64 * map.resolution_m);
    let corners = [[0.0, 0.0], [width, 0.0], [0.0, height], [width, height]];
    let corners = corners.map(|corner| grid.to_grid(corner.into()).coords);
    let [first, others @ ..] = corners;
    let low = others.iter().fold(first, |low, corner| low.inf(corner));
    let high = others.iter().fold(first, |high, corner| high.sup(corner));
    [low, high]
}

impl<'a> Cells<'a> {
    /// Classifies the cells. A cell is free if a disc of `radius_m` in its middle touches nothing.
    /// `solid` is the geometry in the frame of the image.
    pub fn new(raster: &'a Raster<'a>, solid: &'a Solid, layout: Layout, radius_m: f64) -> Self {
        let is_free = |at| solid.is_clear(layout.middle(at), radius_m);
        Self {
            raster,
            solid,
            layout,
            radius_m,
            free: (0..layout.cols * layout.rows).map(is_free).collect(),
        }
    }

    /// Returns the free cell at a point of the map frame.
    pub fn cell_at(&self, what: &'static str, at_m: [f64; 2]) -> Result<usize, MapError> {
        let Layout {
            cols, rows, cell_m, ..
        } = self.layout;
        let in_image = self.raster.map.origin.to_grid(at_m.into());
        let at = self.layout.corner.to_grid(in_image) / cell_m;
        let (x, y) = (at.x.floor(), at.y.floor());
        let fault = |fault: String| Err(MapError::Point { what, at_m, fault });
        let is_inside = (0.0..cols as f64).contains(&x) && (0.0..rows as f64).contains(&y);
        if !is_inside {
            return fault("outside of the map".to_owned());
        }
        let at = (rows - 1 - y as usize) * cols + x as usize;
        match self.free[at] {
            true => Ok(at),
            false => fault(format!("in a wall{}", self.nearest_free(at))),
        }
    }

    /// Describes where the nearest free cell is, for a message.
    fn nearest_free(&self, at: usize) -> String {
        let distance = |&other: &usize| {
            let (dx, dy) = (
                (other % self.layout.cols).abs_diff(at % self.layout.cols),
                (other / self.layout.cols).abs_diff(at / self.layout.cols),
            );
            dx * dx + dy * dy
        };
        let nearest = (0..self.free.len())
            .filter(|&other| self.free[other])
            .min_by_key(distance);
        nearest.map_or_else(
            || format!("; no cell is free{}", self.raster.reason()),
            |free| {
                let middle = self.raster.map.origin.to_map(self.layout.middle(free));
                format!(
                    "; the nearest free cell is at {:.2},{:.2}",
                    middle.x, middle.y
                )
            },
        )
    }

    /// Returns the neighbours of a cell to which the disc can move.
    pub fn neighbours(&self, at: usize) -> impl Iterator<Item = usize> + '_ {
        let (col, row) = (at % self.layout.cols, at / self.layout.cols);
        let beside = [
            (col > 0).then(|| at - 1),
            (col + 1 < self.layout.cols).then_some(at + 1),
            (row > 0).then(|| at - self.layout.cols),
            (row + 1 < self.layout.rows).then_some(at + self.layout.cols),
        ];
        beside
            .into_iter()
            .flatten()
            .filter(move |&other| self.is_open(at, other))
    }

    fn is_open(&self, at: usize, other: usize) -> bool {
        let ends = [at, other].map(|at| self.layout.middle(at));
        self.free[other] && self.solid.is_path_clear(ends, self.radius_m)
    }

    /// Returns for each cell whether it reaches the goal, and the number of moves between such
    /// cells.
    pub fn reached_from(&self, goal: usize) -> (Vec<bool>, usize) {
        let mut reached = vec![false; self.free.len()];
        reached[goal] = true;
        let mut next = VecDeque::from([goal]);
        let mut moves = 0;
        while let Some(at) = next.pop_front() {
            for other in self.neighbours(at) {
                moves += 1;
                if !std::mem::replace(&mut reached[other], true) {
                    next.push_back(other);
                }
            }
        }
        (reached, moves)
    }

    /// Returns the window of all cells that reach the goal for the smallest robot, plus a ring of
    /// walls.
    pub fn window(&self, goal: usize) -> Window {
        let smallest = Self::new(self.raster, self.solid, self.layout, LEAST_RADIUS_M);
        let (reached, _) = smallest.reached_from(goal);
        let free = || (0..reached.len()).filter(|&at| reached[at]);
        let span = |places: &dyn Fn(usize) -> usize| {
            let least = free().map(places).min().unwrap_or(0) as isize;
            let most = free().map(places).max().unwrap_or(0) as isize;
            [least - 1, most + 2]
        };
        Window {
            cols: span(&|at| at % self.layout.cols),
            rows: span(&|at| at / self.layout.cols),
        }
    }

    /// Returns the pose of the lower left corner of a window in the frame of the image.
    fn corner(&self, window: Window) -> Origin {
        let below = self.layout.rows as isize - window.rows[1];
        let metres = |cells: isize| cells as f64 * self.layout.cell_m;
        self.layout
            .corner
            .moved(Point2::new(metres(window.cols[0]), metres(below)))
    }

    /// Builds a maze by writing and reading a world file, so that all of its checks apply.
    pub fn maze(
        &self,
        name: &str,
        start: Option<usize>,
        goal: usize,
        window: Window,
    ) -> Result<Maze, MapError> {
        let mut letters: Vec<char> = self
            .free
            .iter()
            .map(|&free| if free { '.' } else { '#' })
            .collect();
        start.into_iter().for_each(|at| letters[at] = 'S');
        letters[goal] = 'G';
        let letter = |col: isize, row: isize| {
            let inside = (0..self.layout.cols as isize).contains(&col)
                && (0..self.layout.rows as isize).contains(&row);
            let at = row * self.layout.cols as isize + col;
            match usize::try_from(at).ok().filter(|_| inside) {
                Some(at) => letters[at],
                None => '#',
            }
        };
        let [left, right] = window.cols;
        let row = |row| (left..right).map(|col| letter(col, row)).collect();
        let rows: Vec<String> = (window.rows[0]..window.rows[1]).map(row).collect();
        let corner = self.corner(window);
        let solid = self.raster.solid(corner, self.radius_m);
        let solid: serde_json::Value =
            serde_json::from_str(&solid.to_json()).expect("the geometry is written as JSON");
        let world = serde_json::json!({
            "name": name,
            "cell_size_m": self.layout.cell_m,
            "origin": self.raster.map.origin.followed_by(corner),
            "rows": rows,
            "solid": solid,
        });
        let world = world.to_string();
        Ok(Maze::from_json(world.as_bytes(), "the converted map")?)
    }
}
