//! Parallel corridors.

use super::field::Field;
use xcs::random::Stream;

/// Openings from one corridor to the next.
const OPENINGS: usize = 2;

/// Carves every other row, and openings between them.
pub fn carve(field: &mut Field, stream: &mut Stream) {
    let last = field.last();
    for row in (1..=last).step_by(2) {
        (1..=last).for_each(|col| field.set_wall(col, row, false));
        if row > 1 {
            for _ in 0..OPENINGS {
                let col = 1 + stream.below(usize::from(last)) as u16;
                field.set_wall(col, row - 1, false);
            }
        }
    }
}
