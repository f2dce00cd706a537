//! The cells of a map, before they are a maze.

use std::collections::VecDeque;
use std::ops::Range;

use nalgebra::Point2;

use super::{MapError, Occupancy, OccupancyMap};
use crate::world::rows::MAX_SIDE;
use crate::world::{Maze, Origin};

/// How far a border of a cell may lie off that of a pixel by rounding, in pixels.
const ROUNDING: f64 = 1e-6;
/// The smallest and the largest edge of a cell, in metres, as in world files.
const CELL_M: std::ops::RangeInclusive<f64> = 0.1..=10.0;

/// The cells of a map, before they are a maze.
pub(super) struct Cells<'a> {
    pub map: &'a OccupancyMap,
    pub cols: usize,
    pub rows: usize,
    /// Row by row from the top.
    pub free: Vec<bool>,
    cell_m: f64,
    /// Pixels along a cell.
    cell_px: f64,
    unknown_is_free: bool,
}

/// The cells of a map that become a maze, from and to; it may reach one cell beyond the map.
#[derive(Debug, Clone, Copy)]
pub(super) struct Window {
    cols: [isize; 2],
    rows: [isize; 2],
}

impl<'a> Cells<'a> {
    pub fn new(
        map: &'a OccupancyMap,
        cell_m: Option<f64>,
        unknown_is_free: bool,
    ) -> Result<Self, MapError> {
        let cell_m = cell_m.unwrap_or(map.resolution_m);
        let cell_px = cell_m / map.resolution_m;
        let fault = |fault: String| Err(MapError::Cell(fault));
        if !CELL_M.contains(&cell_m) {
            return fault(format!(
                "a cell cannot have {cell_m} m: give `--cell` from {} to {} metres",
                CELL_M.start(),
                CELL_M.end()
            ));
        }
        if cell_px < 1.0 - ROUNDING {
            let pixel_m = map.resolution_m;
            return fault(format!(
                "a cell of {cell_m} m is smaller than a pixel, which has {pixel_m} m"
            ));
        }
        let count = |pixels: usize| (pixels as f64 / cell_px - ROUNDING).ceil() as usize;
        let (cols, rows) = (count(map.width), count(map.height));
        if cols.max(rows) + 2 > MAX_SIDE {
            return fault(format!(
                "{cols} x {rows} cells of {cell_m} m are too many: a world has at most {MAX_SIDE} \
                 columns and rows; give a larger `--cell`"
            ));
        }
        let mut cells = Self {
            map,
            cols,
            rows,
            free: Vec::new(),
            cell_m,
            cell_px,
            unknown_is_free,
        };
        cells.free = (0..cols * rows)
            .map(|at| cells.is_wholly_free(at))
            .collect();
        Ok(cells)
    }

    /// Is a pixel one that the robot may be over?
    pub fn is_free_pixel(&self, col: usize, row: usize) -> bool {
        match self.map.at(col, row) {
            Occupancy::Free => true,
            Occupancy::Occupied => false,
            Occupancy::Unknown => {
                self.unknown_is_free && col < self.map.width && row < self.map.height
            }
        }
    }

    fn is_wholly_free(&self, at: usize) -> bool {
        let (cols, mut rows) = self.pixels(at);
        rows.all(|row| cols.clone().all(|col| self.is_free_pixel(col, row)))
    }

    /// The pixels of a cell: columns, and rows from the top. Cells begin at the lower left corner of
    /// the map; those that reach beyond it have pixels outside.
    pub fn pixels(&self, at: usize) -> (Range<usize>, Range<usize>) {
        let range = |number: usize| {
            let from = (number as f64 * self.cell_px + ROUNDING).floor() as usize;
            let to = ((number + 1) as f64 * self.cell_px - ROUNDING).ceil() as usize;
            from..to
        };
        let (col, from_below) = (at % self.cols, self.rows - 1 - at / self.cols);
        let below = range(from_below);
        let height = self.map.height;
        // A cell that reaches beyond the upper edge has a row that no image has.
        let rows = match below.end > height {
            true => height..height + 1,
            false => height - below.end..height - below.start,
        };
        (range(col), rows)
    }

    pub fn is_pixel_by_pixel(&self) -> bool {
        (self.cell_px - 1.0).abs() <= ROUNDING
    }

    /// The free cell at a point of the map's frame.
    pub fn cell_at(&self, what: &'static str, at_m: [f64; 2]) -> Result<usize, MapError> {
        let at_cells = self.map.origin.to_grid(at_m.into()) / self.cell_m;
        let (x, y) = (at_cells.x.floor(), at_cells.y.floor());
        let fault = |fault: String| Err(MapError::Point { what, at_m, fault });
        let is_inside =
            (0.0..self.cols as f64).contains(&x) && (0.0..self.rows as f64).contains(&y);
        if !is_inside {
            return fault("outside of the map".to_owned());
        }
        let at = (self.rows - 1 - y as usize) * self.cols + x as usize;
        match self.free[at] {
            true => Ok(at),
            false => fault(format!("in a wall{}", self.nearest_free(at))),
        }
    }

    /// Where the nearest free cell is, for a message.
    fn nearest_free(&self, at: usize) -> String {
        let distance = |&other: &usize| {
            let (dx, dy) = (
                (other % self.cols).abs_diff(at % self.cols),
                (other / self.cols).abs_diff(at / self.cols),
            );
            dx * dx + dy * dy
        };
        let nearest = (0..self.free.len())
            .filter(|&other| self.free[other])
            .min_by_key(distance);
        nearest.map_or("; no cell is free".to_owned(), |free| {
            let (cols, rows) = self.pixels(free);
            let [x, y] = self
                .map
                .in_map_m((cols.start + cols.end) / 2, (rows.start + rows.end) / 2);
            format!("; the nearest free cell is at {x:.2},{y:.2}")
        })
    }

    /// The free cells beside one.
    pub fn neighbours(&self, at: usize) -> impl Iterator<Item = usize> + '_ {
        let (col, row) = (at % self.cols, at / self.cols);
        let beside = [
            (col > 0).then(|| at - 1),
            (col + 1 < self.cols).then_some(at + 1),
            (row > 0).then(|| at - self.cols),
            (row + 1 < self.rows).then_some(at + self.cols),
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

    /// What is free, and a ring of walls around it.
    pub fn window(&self) -> Window {
        let free = || (0..self.free.len()).filter(|&at| self.free[at]);
        let span = |places: &dyn Fn(usize) -> usize| {
            let least = free().map(places).min().unwrap_or(0) as isize;
            let most = free().map(places).max().unwrap_or(0) as isize;
            [least - 1, most + 2]
        };
        Window {
            cols: span(&|at| at % self.cols),
            rows: span(&|at| at / self.cols),
        }
    }

    /// The upper left corner of a window in the image, in pixels.
    pub fn corner_px(&self, window: Window) -> [f64; 2] {
        let above = self.rows as f64 * self.cell_px - self.map.height as f64;
        [
            window.cols[0] as f64 * self.cell_px,
            window.rows[0] as f64 * self.cell_px - above,
        ]
    }

    /// The pose of the lower left corner of a window in the map frame.
    fn origin(&self, window: Window) -> Origin {
        let below = self.rows as isize - window.rows[1];
        let metres = |cells: isize| cells as f64 * self.cell_m;
        let corner_m = Point2::new(metres(window.cols[0]), metres(below));
        self.map.origin.moved(corner_m)
    }

    /// Writes a world file and reads it, so that all of its checks hold.
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
            let inside =
                (0..self.cols as isize).contains(&col) && (0..self.rows as isize).contains(&row);
            let at = row * self.cols as isize + col;
            match usize::try_from(at).ok().filter(|_| inside) {
                Some(at) => letters[at],
                None => '#',
            }
        };
        let [left, right] = window.cols;
        let row = |row| (left..right).map(|col| letter(col, row)).collect();
        let rows: Vec<String> = (window.rows[0]..window.rows[1]).map(row).collect();
        let world = serde_json::json!({
            "name": name,
            "cell_size_m": self.cell_m,
            "origin": self.origin(window),
            "rows": rows,
        });
        Ok(Maze::from_json(
            world.to_string().as_bytes(),
            "the converted map",
        )?)
    }
}
