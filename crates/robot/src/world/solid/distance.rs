//! The exact Euclidean distance transform (Meijster, Roerdink and Hesselink 2000), in two passes.

/// Returns the squared distance of each pixel to the nearest solid one, between middles, in pixels.
/// Row by row, as `bits`, which are true for solid pixels. Everything outside is solid.
pub(super) fn squares(width: usize, bits: &[bool]) -> Vec<u32> {
    let mut columns = along_columns(width, bits);
    let mut parts = Vec::new();
    for row in columns.chunks_mut(width.max(1)) {
        across_row(row, &mut parts);
    }
    columns
}

/// Returns the distance of each pixel to the nearest solid one of its column.
fn along_columns(width: usize, bits: &[bool]) -> Vec<u32> {
    let mut distances = vec![0; bits.len()];
    for at in 0..bits.len() {
        let above = if at < width { 0 } else { distances[at - width] };
        distances[at] = if bits[at] { 0 } else { above + 1 };
    }
    for at in (0..bits.len()).rev() {
        let below = distances.get(at + width).copied().unwrap_or(0);
        distances[at] = distances[at].min(below + 1);
    }
    distances
}

/// One column, and the first pixel of the row to which it is nearest.
struct Part {
    col: i64,
    height: i64,
    from: i64,
}

/// Replaces the distances along the columns by the squared distances to the nearest solid pixel.
fn across_row(row: &mut [u32], parts: &mut Vec<Part>) {
    let width = row.len() as i64;
    let square = |col: i64, part: &Part| (col - part.col).pow(2) + part.height.pow(2);
    parts.clear();
    // The columns on both sides of the raster are solid.
    let outside = |col| (col, 0);
    let inside = row.iter().enumerate();
    let inside = inside.map(|(col, &height)| (col as i64, i64::from(height)));
    let columns = [outside(-1)].into_iter().chain(inside);
    for (col, height) in columns.chain([outside(width)]) {
        let mut from = -1;
        while let Some(last) = parts.last() {
            let start = last.from.max(0);
            let new = Part { col, height, from };
            if square(start, last) > square(start, &new) {
                parts.pop();
                continue;
            }
            // The first pixel that is nearer to the new column.
            let sum = col.pow(2) - last.col.pow(2) + height.pow(2) - last.height.pow(2);
            from = sum.div_euclid(2 * (col - last.col)) + 1;
            break;
        }
        if from < width {
            parts.push(Part { col, height, from });
        }
    }
    for col in (0..width).rev() {
        while parts.len() > 1 && parts.last().is_some_and(|part| part.from > col) {
            parts.pop();
        }
        if let Some(part) = parts.last() {
            row[col as usize] = square(col, part) as u32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Returns the same by comparing with every pixel, and with those just outside.
    fn by_comparing(width: usize, bits: &[bool]) -> Vec<u32> {
        let (wide, high) = (width as i64, (bits.len() / width) as i64);
        let is_solid = |col: i64, row: i64| {
            let inside = (0..wide).contains(&col) && (0..high).contains(&row);
            !inside || bits[(row * wide + col) as usize]
        };
        let nearest = |at: usize| {
            let (col, row) = ((at % width) as i64, (at / width) as i64);
            let all = (-1..=high).flat_map(|row| (-1..=wide).map(move |col| (col, row)));
            let solid = all.filter(|&(col, row)| is_solid(col, row));
            let squares = solid.map(|(x, y)| (x - col).pow(2) + (y - row).pow(2));
            squares.min().unwrap() as u32
        };
        (0..bits.len()).map(nearest).collect()
    }

    proptest! {
        #[test]
        fn the_distances_are_those_to_the_nearest_solid_pixel(
            width in 1_usize..14,
            cells in prop::collection::vec(prop::bool::weighted(0.1), 1..180),
        ) {
            let height = (cells.len() / width).max(1);
            let mut bits = cells;
            bits.resize(width * height, false);
            prop_assert_eq!(squares(width, &bits), by_comparing(width, &bits), "{} {:?}", width, bits);
        }
    }
}
