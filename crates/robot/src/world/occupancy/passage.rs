//! A passage of a map in which no cell fits.

use std::fmt;

/// A passage between free cells that is there in the map, but not in the grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Passage {
    /// Its middle in the map's frame, in metres.
    pub at_m: [f64; 2],
    /// How wide it is there, in metres.
    pub width_m: f64,
}

impl fmt::Display for Passage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([x, y], width) = (self.at_m, self.width_m);
        write!(f, "the passage at {x:.2},{y:.2} ({width:.2} m wide)")
    }
}
