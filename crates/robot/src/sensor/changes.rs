//! Percepts that differ from a given one in the cells around the robot.

use super::{Sensor, neighbours};
use xcs::Percept;

impl Sensor {
    /// Returns the percepts in which one of the eight surrounding cells is changed: free if it was
    /// barred, a wall if it was free. Returns none for percepts that do not begin with these cells.
    pub fn changed_surroundings(self, percept: &Percept) -> Vec<Percept> {
        let cells = match self.begins_with_neighbours() {
            true => 0..neighbours::WIDTH / 2,
            false => 0..0,
        };
        cells.map(|cell| turned_over(percept, cell)).collect()
    }
}

/// Returns the percept with one cell changed: free `00` if it was barred, wall `01` if it was free.
fn turned_over(percept: &Percept, cell: usize) -> Percept {
    let (goal, barred) = (2 * cell, 2 * cell + 1);
    let bits = (0..percept.width()).map(|at| match at {
        _ if at == goal => false,
        _ if at == barred => !percept.bit(barred),
        _ => percept.bit(at),
    });
    Percept::from_bits(bits).expect("a percept has room for its own width")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_of_the_eight_cells_is_opened_or_walled() {
        let percept: Percept = "0111000000000000".parse().unwrap();
        let changed = Sensor::Neighbours.changed_surroundings(&percept);
        let texts: Vec<String> = changed.iter().map(Percept::to_string).collect();
        assert_eq!(texts.len(), 8);
        assert_eq!(texts[0], "0011000000000000", "the wall in the north opens");
        assert_eq!(texts[1], "0100000000000000", "free instead of the goal");
        assert_eq!(texts[2], "0111010000000000", "a wall in the east");
        assert!(Sensor::Position.changed_surroundings(&percept).is_empty());
    }
}
