
/// Writes the states of the eight surrounding cells, clockwise from north: free 00, wall or hidden
/// 01.
fn set_ring(percept: &mut Percept, is_free: impl Fn(i32, i32) -> bool) {
    for (at, step) in CLOCKWISE.into_iter().enumerate() {
        if !is_seen(&is_free, [0, 0], step) {
            set(percept, 2 * at + 1);
        }
    }
}
