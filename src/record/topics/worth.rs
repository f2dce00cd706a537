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

/// What each cell is worth: its colour, and its worth, NaN where that is unknown. A vast maze is a
/// single cell.
pub(in crate::record) fn heat(policy: Option<&PolicyMap>, maze: &Maze) -> Bytes {
    let Some(policy) = policy.filter(|_| !maze.is_vast()) else {
        let cells = match maze.is_vast() {
            true => 1,
            false => usize::from(maze.width()) * usize::from(maze.height()),
        };
        return packed(None).repeat(cells).into();
    };
    let ranked = policy.cells().map(|(cell, _)| *cell).zip(policy.ranks());
    let ranks: BTreeMap<Cell, f64> = ranked
        .filter_map(|(cell, rank)| Some((cell, rank?)))
        .collect();
    let rows = (0..maze.height()).rev();
    let cells = rows.flat_map(|row| (0..maze.width()).map(move |col| Cell { col, row }));
    let data = cells.flat_map(|cell| {
        let worth = policy.worth(cell).and_then(|worth| worth.greatest());
        packed(worth.zip(ranks.get(&cell).copied()))
    });
    data.collect::<Vec<u8>>().into()
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

/// The map of what each cell is worth.
pub(in crate::record) fn grid(maze: &Maze, time_ns: u64, heat: Bytes) -> Grid {
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
        data: heat,
    }
}
