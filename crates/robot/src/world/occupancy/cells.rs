//! The cells of an occupancy map, before conversion to a maze.

use std::collections::VecDeque;
use std::ops::Range;

use nalgebra::Point2;

use super::raster::{Raster, Sums};
use super::{MapError, OccupancyMap};
use crate::world::Maze;
use crate::world::rows::MAX_SIDE;

/// The tolerance for rounding when comparing borders of cells and pixels, in pixels.
pub(super) const ROUNDING: f64 = 1e-6;
/// The smallest and the largest edge of a cell, in metres, as in world files.
const CELL_M: std::ops::RangeInclusive<f64> = 0.1..=10.0;

/// The alignment of a grid with an image.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    pub cols: usize,
    pub rows: usize,
    cell_m: f64,
    /// The edge of a cell in pixels.
    cell_px: f64,
    /// The lower left corner of the grid, in pixels to the right and upward from the lower left
    /// corner of the image. Never more than one cell to the left of it or below it.
    offset_px: [f64; 2],
}

/// The cells of an occupancy map, before conversion to a maze.
pub(super) struct Cells<'a> {
    pub raster: &'a Raster<'a>,
    pub layout: Layout,
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
    pub fn new(
        map: &OccupancyMap,
        cell_m: Option<f64>,
        offset_px: [f64; 2],
    ) -> Result<Self, MapError> {
        let cell_m = cell_m.unwrap_or(map.resolution_m);
        let cell_px = cell_m / map.resolution_m;
        let fault = |fault: String| Err(MapError::Cell(fault));
        if !CELL_M.contains(&cell_m) {
            return fault(format!(
                "`--cell` is {cell_m} m, but must be from {} to {}",
                CELL_M.start(),
                CELL_M.end()
            ));
        }
        if cell_px < 1.0 - ROUNDING {
            let pixel_m = map.resolution_m;
            return fault(format!(
                "a cell of {cell_m} m is smaller than a pixel of {pixel_m} m"
            ));
        }
        // Shifting a grid by a whole number of cells does not change it.
        let offset_px = offset_px.map(|pixels| 0.0 - (-pixels).rem_euclid(cell_px));
        let count = |pixels: usize, offset: f64| {
            ((pixels as f64 - offset) / cell_px - ROUNDING).ceil() as usize
        };
        let cols = count(map.width, offset_px[0]);
        let rows = count(map.height, offset_px[1]);
        if cols.max(rows) + 2 > MAX_SIDE {
            return fault(format!(
                "{cols} x {rows} cells of {cell_m} m are too many: a world has at most {MAX_SIDE} \
                 columns and rows; give a larger `--cell`"
            ));
        }
        Ok(Self {
            cols,
            rows,
            cell_m,
            cell_px,
            offset_px,
        })
    }

    /// Returns the pixels of a cell: columns, and rows from the lower edge. For cells that extend
    /// beyond the image, the ranges include pixels outside.
    fn pixels(&self, at: usize) -> [Range<isize>; 2] {
        self.pixels_between(at, 0.0, 1.0)
    }

    /// Returns the pixels of a cell from one share of its edge to another.
    fn pixels_between(&self, at: usize, first: f64, last: f64) -> [Range<isize>; 2] {
        let range = |number: usize, offset: f64| {
            let edge = |share: f64| offset + (number as f64 + share) * self.cell_px;
            let from = (edge(first) + ROUNDING).floor() as isize;
            from..(edge(last) - ROUNDING).ceil() as isize
        };
        let (col, from_below) = (at % self.cols, self.rows - 1 - at / self.cols);
        [
            range(col, self.offset_px[0]),
            range(from_below, self.offset_px[1]),
        ]
    }
}

impl<'a> Cells<'a> {
    /// Classifies the cells. A cell of `n` pixels is free if at most `tolerated(n)` of its pixels
    /// are not free.
    pub fn new(
        raster: &'a Raster<'a>,
        layout: Layout,
        sums: &Sums,
        tolerated: impl Fn(usize) -> usize,
    ) -> Self {
        let mut cells = Self {
            raster,
            layout,
            free: Vec::new(),
        };
        let is_free = |at: usize| {
            let count = layout.pixels(at).map(|range| range.len()).iter().product();
            let (cols, rows) = cells.pixels(at);
            count <= sums.free_in(cols, rows) + tolerated(count) && cells.has_free_middle(at)
        };
        cells.free = (0..layout.cols * layout.rows).map(is_free).collect();
        cells
    }

    /// Returns true if all pixels are free that touch the middle of a cell.
    fn has_free_middle(&self, at: usize) -> bool {
        // The range is a little wider than a point.
        let around = 2.0 * ROUNDING / self.layout.cell_px;
        let middle = self.layout.pixels_between(at, 0.5 - around, 0.5 + around);
        let (width, height) = (self.raster.map.width, self.raster.map.height);
        let [mut cols, rows] = middle.map(|range| range.map(|at| at as usize));
        cols.all(|col| {
            let mut up = rows.clone();
            up.all(|up| col < width && up < height && self.raster.is_free(col, height - 1 - up))
        })
    }

    /// Returns the pixels of a cell inside the image: columns, and rows from the top.
    pub fn pixels(&self, at: usize) -> (Range<usize>, Range<usize>) {
        let map = self.raster.map;
        let within = |edge: isize, size: usize| edge.clamp(0, size as isize) as usize;
        let [cols, below] = self.layout.pixels(at);
        let height = map.height;
        (
            within(cols.start, map.width)..within(cols.end, map.width),
            height - within(below.end, height)..height - within(below.start, height),
        )
    }

    /// Returns the free cell at a point of the map frame.
    pub fn cell_at(&self, what: &'static str, at_m: [f64; 2]) -> Result<usize, MapError> {
        let map = self.raster.map;
        let Layout { cols, rows, .. } = self.layout;
        let at_px = map.origin.to_grid(at_m.into()) / map.resolution_m;
        let [left, lower] = self.layout.offset_px;
        let x = ((at_px.x - left) / self.layout.cell_px).floor();
        let y = ((at_px.y - lower) / self.layout.cell_px).floor();
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
        nearest.map_or("; no cell is free".to_owned(), |free| {
            let (cols, rows) = self.pixels(free);
            let [x, y] = self
                .raster
                .map
                .in_map_m((cols.start + cols.end) / 2, (rows.start + rows.end) / 2);
            format!("; the nearest free cell is at {x:.2},{y:.2}")
        })
    }

    /// Returns the free neighbours of a cell.
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
            .filter(|&other| self.free[other])
    }

    pub fn reached_from(&self, goal: usize) -> Vec<bool> {
        let mut reached = vec![false; self.free.len()];
        reached[goal] = true;
        let mut next = VecDeque::from([goal]);
        while let Some(at) = next.pop_front() {
            for other in self.neighbours(at) {
                if !std::mem::replace(&mut reached[other], true) {
                    next.push_back(other);
                }
            }
        }
        reached
    }

    /// Returns the window of all free cells plus a ring of walls.
    pub fn window(&self) -> Window {
        let free = || (0..self.free.len()).filter(|&at| self.free[at]);
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

    /// Returns the upper left corner of a window in the image, in pixels.
    pub fn corner_px(&self, window: Window) -> [f64; 2] {
        let Layout {
            cell_px, offset_px, ..
        } = self.layout;
        let above = self.layout.rows as f64 * cell_px + offset_px[1];
        let above = above - self.raster.map.height as f64;
        [
            offset_px[0] + window.cols[0] as f64 * cell_px,
            window.rows[0] as f64 * cell_px - above,
        ]
    }

    /// Returns the offset of the grid, in metres to the right and upward.
    pub fn offset_m(&self) -> [f64; 2] {
        let resolution_m = self.raster.map.resolution_m;
        self.layout.offset_px.map(|pixels| pixels * resolution_m)
    }

    /// Returns the lower left corner of a window, in metres to the right and upward from the lower
    /// left corner of the image.
    fn corner_m(&self, window: Window) -> Point2<f64> {
        let below = self.layout.rows as isize - window.rows[1];
        let [left, lower] = self.offset_m();
        let metres = |cells: isize| cells as f64 * self.layout.cell_m;
        Point2::new(left + metres(window.cols[0]), lower + metres(below))
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
        let corner_m = self.corner_m(window);
        let world = serde_json::json!({
            "name": name,
            "cell_size_m": self.layout.cell_m,
            "origin": self.raster.map.origin.moved(corner_m),
            "rows": rows,
        });
        let maze = Maze::from_json(world.to_string().as_bytes(), "the converted map")?;
        Ok(maze.with_solid(self.raster.solid(corner_m)))
    }
}
