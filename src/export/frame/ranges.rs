
/// For each main direction, clockwise from north: is it free for one cell, for two, for three, and is the
/// diagonal cell free that follows clockwise?
fn set_ring(percept: &mut Percept, is_free: impl Fn(i32, i32) -> bool) {
    for quarter in 0..4 {
        let free = free_cells(&is_free, &[CLOCKWISE[2 * quarter]], 3);
        (0..free).for_each(|far| set(percept, 4 * quarter + far));
        if is_seen(&is_free, [0, 0], CLOCKWISE[2 * quarter + 1]) {
            set(percept, 4 * quarter + 3);
        }
    }
}
