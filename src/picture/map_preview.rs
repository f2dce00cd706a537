//! A preview of a converted map: the map, the cells of the grid, the start and the goals.

use resvg::tiny_skia::{
    Color, FillRule, FilterQuality, Paint, PathBuilder, Pixmap, PixmapPaint, PremultipliedColorU8,
    Rect, Stroke, Transform,
};

use crate::world::{Cell, Gridded, Occupancy, OccupancyMap};

/// Approximate length of the longer side of the picture, in pixels.
const SIDE: f32 = 1600.0;
/// Smallest cell, in pixels, that gets a frame. Frames around smaller cells would hide the map.
const SMALLEST_CELL: f64 = 5.0;
/// Radius of the start mark, in cells.
const START_MARK: f32 = 0.3;

/// Renders a PNG file with the part of the map that the maze covers in grey. Free cells have a blue
/// frame, goals are green, and the start is an orange disc.
///
/// # Errors
/// When the picture is too large.
pub fn map_preview(gridded: &Gridded, map: &OccupancyMap) -> Result<Vec<u8>, String> {
    let too_large = || format!("{} x {} pixels are too many", map.width, map.height);
    let cell_px = gridded.maze.cell_size_m() / map.resolution_m;
    let [left, top] = gridded.corner_px.map(|edge| (edge - cell_px) as f32);
    let length = |cells: u16| ((f64::from(cells) + 2.0) * cell_px) as f32;
    let (width, height) = (length(gridded.maze.width()), length(gridded.maze.height()));
    let scale = (SIDE / width.max(height)).clamp(0.05, 16.0);
    let side = |pixels: f32| ((pixels * scale).ceil() as u32).max(1);
    let mut canvas = Pixmap::new(side(width), side(height)).ok_or_else(too_large)?;
    let plan = plan(map).ok_or_else(too_large)?;
    let look = Transform::from_translate(-left, -top).post_scale(scale, scale);
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
    for cell in gridded.maze.free_cells() {
        draw_cell(
            &mut canvas,
            gridded,
            cell,
            (gridded.cell_corner_px(map, cell), cell_px),
            look,
        );
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

/// Draws a free cell: its frame, and the goal or start mark.
fn draw_cell(
    canvas: &mut Pixmap,
    gridded: &Gridded,
    cell: Cell,
    ([left, top], cell_px): ([f64; 2], f64),
    look: Transform,
) {
    let edge = cell_px as f32;
    let Some(rect) = Rect::from_xywh(left as f32, top as f32, edge, edge) else {
        return;
    };
    let mut paint = Paint::default();
    if gridded.maze.is_goal(cell) {
        paint.set_color_rgba8(44, 160, 44, 200);
        canvas.fill_rect(rect, &paint, look, None);
    }
    if cell_px * f64::from(look.sx) >= SMALLEST_CELL {
        paint.set_color_rgba8(31, 119, 180, 160);
        let stroke = Stroke {
            width: 1.0 / look.sx,
            ..Stroke::default()
        };
        canvas.stroke_path(&PathBuilder::from_rect(rect), &paint, &stroke, look, None);
    }
    let (x, y) = (rect.left() + edge / 2.0, rect.top() + edge / 2.0);
    let mark = PathBuilder::from_circle(x, y, START_MARK * edge);
    if let Some(mark) = mark.filter(|_| gridded.maze.starts().next() == Some(cell)) {
        paint.set_color_rgba8(255, 127, 14, 255);
        canvas.fill_path(&mark, &paint, FillRule::Winding, look, None);
    }
}
