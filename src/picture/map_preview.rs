//! A preview of a converted map: the map, the cells of the grid, the start and the goals.

use resvg::tiny_skia::{
    Color, FillRule, FilterQuality, Paint, PathBuilder, Pixmap, PixmapPaint, Point,
    PremultipliedColorU8, Stroke, Transform,
};

use crate::world::{Cell, Maze, Occupancy, OccupancyMap};

/// Approximate length of the longer side of the picture, in pixels.
const SIDE: f32 = 1600.0;
/// Smallest cell, in pixels, that gets a frame. Frames around smaller cells would hide the map.
const SMALLEST_CELL: f32 = 5.0;
/// Radius of the start mark, in cells.
const START_MARK: f32 = 0.3;

/// Renders a PNG file with the part of the map that the maze covers in grey. Free cells have a blue
/// frame, goals are green, and the start is an orange disc.
///
/// # Errors
/// When the picture is too large.
pub fn map_preview(maze: &Maze, map: &OccupancyMap) -> Result<Vec<u8>, String> {
    let too_large = || format!("{} x {} pixels are too many", map.width, map.height);
    let grid = Grid { maze, map };
    let [low, high] = grid.extent();
    let (width, height) = (high.x - low.x, high.y - low.y);
    let scale = (SIDE / width.max(height)).clamp(0.05, 16.0);
    let side = |pixels: f32| ((pixels * scale).ceil() as u32).max(1);
    let mut canvas = Pixmap::new(side(width), side(height)).ok_or_else(too_large)?;
    let plan = plan(map).ok_or_else(too_large)?;
    let look = Transform::from_translate(-low.x, -low.y).post_scale(scale, scale);
    let paint = PixmapPaint {
        quality: if scale < 1.0 {
            FilterQuality::Bilinear
        } else {
            FilterQuality::Nearest
        },
        ..PixmapPaint::default()
    };
    canvas.fill(Color::WHITE);
    canvas.draw_pixmap(0, 0, plan.as_ref(), &paint, look, None);
    for cell in maze.free_cells() {
        grid.draw_cell(&mut canvas, cell, look);
    }
    canvas.encode_png().map_err(|fault| fault.to_string())
}

/// Renders the pixels of the map.
fn plan(map: &OccupancyMap) -> Option<Pixmap> {
    let mut plan = Pixmap::new(map.width as u32, map.height as u32)?;
    let places = (0..map.height).flat_map(|row| (0..map.width).map(move |col| (col, row)));
    for (pixel, (col, row)) in plan.pixels_mut().iter_mut().zip(places) {
        let grey = match map.at(col, row) {
            Occupancy::Free => 254,
            Occupancy::Occupied => 0,
            Occupancy::Unknown => 205,
        };
        *pixel = PremultipliedColorU8::from_rgba(grey, grey, grey, 255)?;
    }
    Some(plan)
}

/// The grid of a maze over the pixels of a map.
struct Grid<'a> {
    maze: &'a Maze,
    map: &'a OccupancyMap,
}

impl Grid<'_> {
    /// Returns a point of the grid, in cells from its lower left corner, in pixels from the upper
    /// left corner of the image.
    fn pixel(&self, col: f64, row: f64) -> Point {
        let in_grid = nalgebra::Point2::new(col, row) * self.maze.cell_size_m();
        let in_map = self.maze.point_in_map(in_grid);
        let in_image = self.map.origin.to_grid(in_map) / self.map.resolution_m;
        Point::from_xy(
            in_image.x as f32,
            (self.map.height as f64 - in_image.y) as f32,
        )
    }

    /// Returns the upper left and the lower right corner of the picture, a cell larger than the
    /// maze on each side.
    fn extent(&self) -> [Point; 2] {
        let [cols, rows] = [self.maze.width(), self.maze.height()].map(f64::from);
        let (right, top) = (cols + 1.0, rows + 1.0);
        let corners = [[-1.0, -1.0], [right, -1.0], [-1.0, top], [right, top]];
        let corners = corners.map(|[col, row]| self.pixel(col, row));
        let [first, others @ ..] = corners;
        others.iter().fold([first; 2], |[low, high], corner| {
            [
                Point::from_xy(low.x.min(corner.x), low.y.min(corner.y)),
                Point::from_xy(high.x.max(corner.x), high.y.max(corner.y)),
            ]
        })
    }

    /// Draws a free cell: its frame, and the goal or start mark.
    fn draw_cell(&self, canvas: &mut Pixmap, cell: Cell, look: Transform) {
        let (col, row) = (
            f64::from(cell.col),
            f64::from(self.maze.height() - cell.row) - 1.0,
        );
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let mut frame = PathBuilder::new();
        for (number, [x, y]) in corners.into_iter().enumerate() {
            let Point { x, y } = self.pixel(col + x, row + y);
            match number {
                0 => frame.move_to(x, y),
                _ => frame.line_to(x, y),
            }
        }
        frame.close();
        let Some(frame) = frame.finish() else {
            return;
        };
        let mut paint = Paint::default();
        if self.maze.is_goal(cell) {
            paint.set_color_rgba8(44, 160, 44, 200);
            canvas.fill_path(&frame, &paint, FillRule::Winding, look, None);
        }
        let edge = (self.maze.cell_size_m() / self.map.resolution_m) as f32;
        if edge * look.sx >= SMALLEST_CELL {
            paint.set_color_rgba8(31, 119, 180, 160);
            let stroke = Stroke {
                width: 1.0 / look.sx,
                ..Stroke::default()
            };
            canvas.stroke_path(&frame, &paint, &stroke, look, None);
        }
        let middle = self.pixel(col + 0.5, row + 0.5);
        let mark = PathBuilder::from_circle(middle.x, middle.y, START_MARK * edge);
        if let Some(mark) = mark.filter(|_| self.maze.starts().next() == Some(cell)) {
            paint.set_color_rgba8(255, 127, 14, 255);
            canvas.fill_path(&mark, &paint, FillRule::Winding, look, None);
        }
    }
}
