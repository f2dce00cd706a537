//! The cells around the robot, as observed.

/// The number of cells that the map covers in each direction.
const REACH: i32 = 9;
/// The number of cells along each side of the map.
const SIDE: usize = 2 * REACH as usize + 1;
/// The evidence above which a cell is free. One or two beams that did not come back are less.
const FREE_ABOVE: i32 = 30;

/// The cells around the robot, as observed by the beams of the last action.
///
/// Each beam adds evidence for or against a cell being free. A cell without evidence is hidden, and
/// counts as a wall.
#[derive(Debug, Clone, PartialEq)]
pub struct Surroundings {
    /// The cell in the middle of the map; column to the east, row to the north.
    middle: [i32; 2],
    /// The estimated cell of the robot.
    here: [i32; 2],
    /// The evidence, row by row from the south.
    evidence: Vec<i32>,
}

impl Surroundings {
    /// Creates a map without evidence around the cell `middle` (east, north).
    pub(crate) fn unknown(middle: [i32; 2]) -> Self {
        Self {
            middle,
            here: middle,
            evidence: vec![0; SIDE * SIDE],
        }
    }

    /// Clears the map, and centres it on the cell `middle`, where the robot is.
    pub(crate) fn forget(&mut self, middle: [i32; 2]) {
        self.middle = middle;
        self.here = middle;
        self.evidence.fill(0);
    }

    /// Adds evidence that a cell is free, or a wall if it is negative.
    pub(crate) fn add(&mut self, cell: [i32; 2], evidence: i32) {
        if let Some(known) = self.entry(cell).and_then(|at| self.evidence.get_mut(at)) {
            *known += evidence;
        }
    }

    /// Sets the estimated cell of the robot.
    pub(crate) fn stand_in(&mut self, here: [i32; 2]) {
        self.here = here;
    }

    /// Returns true if the cell at an offset to the east and to the north of the robot was observed
    /// to be free. Walls and hidden cells are not.
    pub fn is_free(&self, east: i32, north: i32) -> bool {
        let cell = [self.here[0] + east, self.here[1] + north];
        let known = self.entry(cell).and_then(|at| self.evidence.get(at));
        known.is_some_and(|&evidence| evidence > FREE_ABOVE)
    }

    fn entry(&self, cell: [i32; 2]) -> Option<usize> {
        // Negative numbers become large ones.
        let x = (cell[0] - self.middle[0] + REACH) as usize;
        let y = (cell[1] - self.middle[1] + REACH) as usize;
        (x < SIDE && y < SIDE).then(|| y * SIDE + x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_beyond_the_map_are_unknown_in_every_direction() {
        let mut map = Surroundings::unknown([5, 5]);
        for far in [[5, -20], [5, 30], [-20, 5], [30, 5], [-20, -20]] {
            map.add(far, 1_000);
            assert!(!map.is_free(far[0] - 5, far[1] - 5), "{far:?}");
        }
        map.add([5 + REACH, 5 - REACH], FREE_ABOVE + 1);
        assert!(map.is_free(REACH, -REACH), "control: the corner of the map");
    }
}
