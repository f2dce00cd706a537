//! The rays of cells that a lidar percept shows, as a table for exported source code.

use serde::Serialize;

use crate::sensor::Sensor;
use crate::world::Direction;

/// The most cells between the robot and the cell in which its scan began: it moves by one cell, and
/// its estimate may jump by another.
const MOVES: usize = 2;

/// Offsets in cells to the east and to the north.
type Step = [i32; 2];

/// A ray from the robot's cell, and how a percept shows its number of free cells.
#[derive(Serialize)]
pub(super) struct Ray {
    along: Step,
    /// Each second of three steps.
    across: Step,
    bits: usize,
    /// The value of the bits for each number of free cells.
    codes: Vec<u8>,
}

impl Ray {
    /// Returns how many cells in each direction a scan must cover.
    pub fn reach(&self) -> usize {
        self.codes.len() - 1 + MOVES
    }

    /// A ray in one of eight directions, clockwise from north.
    fn straight(eighth: usize, bits: usize, codes: &[u8]) -> Self {
        let along = step(eighth);
        Self {
            along,
            across: along,
            bits,
            codes: codes.to_vec(),
        }
    }

    /// One of sixteen rays, clockwise from north. Those between the eight directions go two cells
    /// along and one across.
    fn beam(beam: usize) -> Self {
        let ray = Self::straight(beam / 2, 3, &[0, 1, 2, 3, 4, 5, 6, 7]);
        if beam.is_multiple_of(2) {
            return ray;
        }
        let steps = [step(beam / 2), step(beam / 2 + 1)];
        let [along, diagonal] = match beam % 4 {
            1 => steps,
            _ => [steps[1], steps[0]],
        };
        let across = [diagonal[0] - along[0], diagonal[1] - along[1]];
        Self {
            along,
            across,
            ..ray
        }
    }
}

fn step(eighth: usize) -> Step {
    let (east, south) = Direction::CLOCKWISE[eighth % 8].offset();
    [east, -south]
}

/// Returns the rays that the percept of a sensor shows, in the order of its bits.
pub(super) fn shown_by(sensor: Sensor) -> Vec<Ray> {
    match sensor {
        Sensor::Neighbours | Sensor::Position | Sensor::NeighboursPosition => Vec::new(),
        // Free 00, wall or hidden 01.
        Sensor::Lidar | Sensor::LidarPosition => (0..8)
            .map(|eighth| Ray::straight(eighth, 2, &[1, 0]))
            .collect(),
        // A bit for each of three cells, then one for the diagonal that follows clockwise.
        Sensor::LidarRanges => (0..8)
            .map(|eighth| match eighth % 2 {
                0 => Ray::straight(eighth, 3, &[0b000, 0b100, 0b110, 0b111]),
                _ => Ray::straight(eighth, 1, &[0, 1]),
            })
            .collect(),
        Sensor::LidarBeams => (0..16).map(Ray::beam).collect(),
    }
}
