//! A preview of a converted map: the map, the cells of the grid, the start and the goals.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use nalgebra::Point2;

use super::svg::{Drawing, Element, short};
use crate::world::{Cell, Maze, Occupancy, OccupancyMap};

/// Approximate length of the longer side of the picture, in pixels.
const SIDE: f64 = 1200.0;
/// Smallest cell, in pixels, that gets a frame. Frames around smaller cells would hide the map.
const SMALLEST_CELL: f64 = 5.0;
/// The most crosses in a row of the picture.
const MOST_CROSSES: f64 = 9.0;
/// Half the length of the arms of a cross, in pixels.
const ARM: f64 = 6.0;
/// Radius of the start mark, in cells.
const START_MARK: f64 = 0.3;
const FRAME: &str = "#1f77b4";
const GOAL: &str = "#2ca02c";
const START: &str = "#ff7f0e";
const CROSS: &str = "#d62728";

/// Renders an SVG document with the part of the map that the maze covers in grey. Free cells have a
/// blue frame, goals are green, and the start is an orange disc. Red crosses have their coordinates in
/// the map frame, in metres.
///
/// # Errors
/// When the pixels of the map cannot be encoded.
pub fn map_preview(maze: &Maze, map: &OccupancyMap) -> Result<String, String> {
    let grid = Grid::new(maze, map);
    let mut elements = vec![grid.background(&pixels(map).map_err(|fault| fault.to_string())?)];
    let goals = maze.goals().iter();
    elements.extend(
        goals.map(|&goal| outline(&grid.frame(goal), [("fill", GOAL), ("fill-opacity", "0.8")])),
    );
    if grid.cell_px() >= SMALLEST_CELL {
        let frames: String = maze.free_cells().map(|cell| grid.frame(cell)).collect();
        elements.push(outline(&frames, [("fill", "none"), ("stroke", FRAME)]));
    }
    elements.extend(maze.starts().next().map(|start| grid.start_mark(start)));
    elements.extend(grid.coordinates());
    Ok(Drawing {
        width: grid.size_px[0].ceil() as u32,
        height: grid.size_px[1].ceil() as u32,
        title: maze.name().to_owned(),
        definitions: "",
        elements,
    }
    .document())
}

/// Encodes the pixels of the map as a PNG image.
fn pixels(map: &OccupancyMap) -> Result<Vec<u8>, png::EncodingError> {
    let places = (0..map.height).flat_map(|row| (0..map.width).map(move |col| (col, row)));
    let greys = places.map(|(col, row)| match map.at(col, row) {
        Occupancy::Free => 254,
        Occupancy::Occupied => 0,
        Occupancy::Unknown => 205,
    });
    let greys: Vec<u8> = greys.collect();
    let mut image = Vec::new();
    let mut encoder = png::Encoder::new(&mut image, map.width as u32, map.height as u32);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.write_header()?.write_image_data(&greys)?;
    Ok(image)
}

/// Returns the distance between two coordinates in a picture of this length, in metres: a round
/// number.
fn apart_m(length_m: f64) -> f64 {
    let decades = (-1..6).map(|power| 10.0_f64.powi(power));
    let mut round = decades.flat_map(|decade| [1.0, 2.0, 5.0].map(|factor| factor * decade));
    round
        .find(|apart_m| length_m / apart_m <= MOST_CROSSES)
        .unwrap_or(length_m)
}

/// Draws a path.
fn outline<const N: usize>(path: &str, style: [(&'static str, &str); N]) -> Element {
    let style = style.map(|(name, value)| (name, value.to_owned()));
    Element::new("path", [("d", path.to_owned())]).with(style)
}

/// The grid of a maze over the pixels of a map.
struct Grid<'a> {
    maze: &'a Maze,
    map: &'a OccupancyMap,
    /// Pixels of the picture per pixel of the map.
    scale: f64,
    /// The upper left corner of the picture, in pixels of the map.
    corner: Point2<f64>,
    /// Width and height of the picture.
    size_px: [f64; 2],
}

impl<'a> Grid<'a> {
    /// Lays out a picture that is a cell larger than the maze on each side.
    fn new(maze: &'a Maze, map: &'a OccupancyMap) -> Self {
        let mut grid = Self {
            maze,
            map,
            scale: 1.0,
            corner: Point2::origin(),
            size_px: [0.0; 2],
        };
        let [cols, rows] = [maze.width(), maze.height()].map(f64::from);
        let (right, top) = (cols + 1.0, rows + 1.0);
        let corners = [[-1.0, -1.0], [right, -1.0], [-1.0, top], [right, top]];
        let corners = corners.map(|[col, row]| grid.pixel(col, row));
        let low = corners
            .iter()
            .fold(corners[0], |low, corner| low.inf(corner));
        let high = corners
            .iter()
            .fold(corners[0], |high, corner| high.sup(corner));
        let size = high - low;
        grid.scale = (SIDE / size.max()).clamp(0.05, 16.0);
        grid.size_px = [size.x, size.y].map(|side| side * grid.scale);
        grid.corner = low;
        grid
    }

    /// Returns the edge of a cell in the picture.
    fn cell_px(&self) -> f64 {
        self.maze.cell_size_m() / self.map.resolution_m * self.scale
    }

    /// Returns a point of the grid, in cells from its lower left corner, in pixels of the picture.
    fn pixel(&self, col: f64, row: f64) -> Point2<f64> {
        let in_grid = Point2::new(col, row) * self.maze.cell_size_m();
        self.pixel_of_map(self.maze.point_in_map(in_grid))
    }

    /// Returns a point of the map frame, in metres, in pixels of the picture.
    fn pixel_of_map(&self, in_map: Point2<f64>) -> Point2<f64> {
        let in_image = self.map.origin.to_grid(in_map) / self.map.resolution_m;
        let from_top = self.map.height as f64 - in_image.y;
        ((Point2::new(in_image.x, from_top) - self.corner) * self.scale).into()
    }

    /// Returns a point of the picture in the map frame, in metres.
    fn point_in_map(&self, [x, y]: [f64; 2]) -> Point2<f64> {
        let in_image = Point2::new(x, y) / self.scale + self.corner.coords;
        let from_bottom = self.map.height as f64 - in_image.y;
        let in_raster = Point2::new(in_image.x, from_bottom) * self.map.resolution_m;
        self.map.origin.to_map(in_raster)
    }

    /// Returns crosses at round points of the map frame, with their coordinates.
    fn coordinates(&self) -> Vec<Element> {
        let [width, height] = self.size_px;
        let ends = [[0.0, 0.0], [width, 0.0], [0.0, height], [width, height]];
        let ends = ends.map(|end| self.point_in_map(end).coords);
        let least = ends.iter().fold(ends[0], |least, end| least.inf(end));
        let most = ends.iter().fold(ends[0], |most, end| most.sup(end));
        let apart_m = apart_m((most - least).max());
        let numbers = |axis: usize| {
            let first = (least[axis] / apart_m).ceil() as i64;
            (first..=(most[axis] / apart_m) as i64).map(move |number| number as f64 * apart_m)
        };
        let points = numbers(0).flat_map(|x| numbers(1).map(move |y| [x, y]));
        points.flat_map(|point| self.cross(point)).collect()
    }

    /// Returns a cross at a point of the map frame, and its coordinates.
    fn cross(&self, [x, y]: [f64; 2]) -> [Element; 2] {
        let at = self.pixel_of_map(Point2::new(x, y));
        let (left, top) = (short(at.x - ARM), short(at.y - ARM));
        let [middle_x, middle_y, length] = [at.x, at.y, 2.0 * ARM].map(short);
        let path = format!("M{left} {middle_y}h{length}M{middle_x} {top}v{length}");
        let text = [
            ("x", short(at.x + 4.0)),
            ("y", short(at.y - 4.0)),
            ("font-size", "14".to_owned()),
            ("fill", CROSS.to_owned()),
        ];
        [
            outline(&path, [("fill", "none"), ("stroke", CROSS)]),
            // Tenths have no exact form in binary.
            Element::new("text", text).with_text(format!("{},{}", short(x), short(y))),
        ]
    }

    /// Returns the map, from its pixels as a PNG image.
    fn background(&self, image: &[u8]) -> Element {
        let corner = -self.corner * self.scale;
        let size = [self.map.width, self.map.height].map(|pixels| pixels as f64 * self.scale);
        Element::new(
            "image",
            [
                ("x", short(corner.x)),
                ("y", short(corner.y)),
                ("width", short(size[0])),
                ("height", short(size[1])),
                ("preserveAspectRatio", "none".to_owned()),
                ("style", "image-rendering:pixelated".to_owned()),
                (
                    "href",
                    format!("data:image/png;base64,{}", STANDARD.encode(image)),
                ),
            ],
        )
    }

    /// Returns the closed path around a cell.
    fn frame(&self, cell: Cell) -> String {
        let [col, row] = self.south_west(cell);
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let corners = corners.map(|[x, y]| {
            let at = self.pixel(col + x, row + y);
            format!("{} {}", short(at.x), short(at.y))
        });
        format!("M{}z", corners.join("L"))
    }

    /// Returns the disc in the middle of the start.
    fn start_mark(&self, start: Cell) -> Element {
        let [col, row] = self.south_west(start);
        let middle = self.pixel(col + 0.5, row + 0.5);
        Element::new(
            "circle",
            [
                ("cx", short(middle.x)),
                ("cy", short(middle.y)),
                ("r", short(START_MARK * self.cell_px())),
                ("fill", START.to_owned()),
            ],
        )
    }

    /// Returns the lower left corner of a cell, in cells from that of the grid.
    fn south_west(&self, cell: Cell) -> [f64; 2] {
        let row = f64::from(self.maze.height() - cell.row) - 1.0;
        [f64::from(cell.col), row]
    }
}
