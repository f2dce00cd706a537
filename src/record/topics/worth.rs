//! `/worth`: the greatest worth of each cell as a heat map.

use std::collections::BTreeMap;

use foxglove::bytes::Bytes;
use foxglove::messages::{Grid, PackedElementField, Vector2, packed_element_field::NumericType};

use super::rounded;
use super::scene::{WORLD, place, timestamp};
use crate::episode::PolicyMap;
use crate::world::{Cell, Maze};

/// Bytes per cell: four of colour, then the worth as a `f32`.
const CELL_BYTES: u32 = 8;
/// Red below 0, blue above; the opacity tells the rank among all cells, so that cells far from the
/// goal differ, too.
const BAD: [u8; 3] = [0xf0, 0x6a, 0x70];
const GOOD: [u8; 3] = [0x5a, 0xa9, 0xff];

/// The map; cells without a worth are transparent and hold NaN. A vast maze has a single one.
pub(in crate::record) fn grid(policy: &PolicyMap, maze: &Maze, time_ns: u64) -> Grid {
    if maze.is_vast() {
        return empty(maze, time_ns);
    }
    let ranked = policy.cells().map(|(cell, _)| *cell).zip(policy.ranks());
    let ranks: BTreeMap<Cell, f64> = ranked
        .filter_map(|(cell, rank)| Some((cell, rank?)))
        .collect();
    let mut data = Vec::new();
    for row in (0..maze.height()).rev() {
        for col in 0..maze.width() {
            let cell = Cell { col, row };
            let worth = policy.worth(cell).and_then(|worth| worth.greatest());
            data.extend(packed(worth.zip(ranks.get(&cell).copied())));
        }
    }
    framed(maze, time_ns, data)
}

/// The map of someone who knows nothing.
pub(in crate::record) fn empty(maze: &Maze, time_ns: u64) -> Grid {
    let cells = match maze.is_vast() {
        true => 1,
        false => usize::from(maze.width()) * usize::from(maze.height()),
    };
    framed(maze, time_ns, packed(None).repeat(cells))
}

/// Colour and worth of a cell, from its worth and rank.
fn packed(known: Option<(f64, f64)>) -> [u8; CELL_BYTES as usize] {
    let Some((worth, rank)) = known else {
        let [a, b, c, d] = f32::NAN.to_le_bytes();
        return [0, 0, 0, 0, a, b, c, d];
    };
    let [r, g, b] = if worth < 0.0 { BAD } else { GOOD };
    let share = if worth < 0.0 { 1.0 - rank } else { rank };
    let opacity = (20.0 + 180.0 * share).round() as u8;
    let [w, x, y, z] = (rounded(worth) as f32).to_le_bytes();
    [r, g, b, opacity, w, x, y, z]
}

fn framed(maze: &Maze, time_ns: u64, data: Vec<u8>) -> Grid {
    let unit = maze.cell_size_m();
    let (width, height) = (maze.width(), maze.height());
    let (columns, cells_wide, cells_high) = match maze.is_vast() {
        true => (1, width, height),
        false => (u32::from(width), 1, 1),
    };
    let field = |name: &str, offset, kind: NumericType| PackedElementField {
        name: name.to_owned(),
        offset,
        r#type: kind as i32,
    };
    Grid {
        timestamp: Some(timestamp(time_ns)),
        frame_id: WORLD.to_owned(),
        pose: place(0.0, 0.0, 0.002 * unit),
        column_count: columns,
        cell_size: Some(Vector2 {
            x: f64::from(cells_wide) * unit,
            y: f64::from(cells_high) * unit,
        }),
        row_stride: columns * CELL_BYTES,
        cell_stride: CELL_BYTES,
        fields: vec![
            field("red", 0, NumericType::Uint8),
            field("green", 1, NumericType::Uint8),
            field("blue", 2, NumericType::Uint8),
            field("alpha", 3, NumericType::Uint8),
            field("worth", 4, NumericType::Float32),
        ],
        data: Bytes::from(data),
    }
}
