//! Obstacles at random.

use super::field::Field;
use xcs::random::Stream;

/// The share of cells that become walls; with more, the field falls apart into small pieces.
const DENSITY: f64 = 0.3;

/// Scatters single walls over a free field.
pub fn carve(field: &mut Field, stream: &mut Stream) {
    for row in 1..=field.last() {
        for col in 1..=field.last() {
            field.set_wall(col, row, stream.chance(DENSITY));
        }
    }
    // Guarantees room for a start and a goal two steps away, however small the field is.
    (1..=3).for_each(|col| field.set_wall(col, 1, false));
}
