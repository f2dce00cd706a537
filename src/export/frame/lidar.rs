
/// Returns true if the next cell is free, and not hidden behind the corner of two walls.
fn is_seen(is_free: &impl Fn(i32, i32) -> bool, [east, north]: [i32; 2], [x, y]: [i32; 2]) -> bool {
    let hidden = x != 0 && y != 0 && !is_free(east + x, north) && !is_free(east, north + y);
    !hidden && is_free(east + x, north + y)
}

fn set_ring_from_map(percept: &mut Percept, state: impl Fn(i32, i32) -> CellState) {
    set_ring(percept, |east, north| state(east, north) != CellState::Wall);
}
