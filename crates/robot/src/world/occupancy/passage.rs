//! A passage of a map that is too narrow for a cell.

use std::fmt;

/// A passage between free cells that exists in the map, but not in the grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Passage {
    /// The middle in the map frame, in metres.
    pub at_m: [f64; 2],
    /// The width at the middle, in metres.
    pub width_m: f64,
}

impl fmt::Display for Passage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([x, y], width) = (self.at_m, self.width_m);
        write!(f, "the passage at {x:.2},{y:.2} ({width:.2} m wide)")
    }
}
