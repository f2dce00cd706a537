/// East and north components of the eight directions, clockwise from north.
const CLOCKWISE: [[i32; 2]; 8] = [
    [0, 1],
    [1, 1],
    [1, 0],
    [1, -1],
    [0, -1],
    [-1, -1],
    [-1, 0],
    [-1, 1],
];

/// Writes the states of the surrounding cells, clockwise from north: free 00, wall 01, goal 11.
fn set_ring_from_map(percept: &mut Percept, state: impl Fn(i32, i32) -> CellState) {
    for (at, [east, north]) in CLOCKWISE.into_iter().enumerate().take(RING_BITS / 2) {
        let state = state(east, north);
        if state == CellState::Goal {
            set(percept, 2 * at);
        }
        if state != CellState::Free {
            set(percept, 2 * at + 1);
        }
    }
}
