
/// Writes four bits for each main direction, clockwise from north. The first three are set if one,
/// two and three cells are free. The fourth is set if the next diagonal cell, clockwise, is free.
fn set_ring(percept: &mut Percept, is_free: impl Fn(i32, i32) -> bool) {
    for quarter in 0..4 {
        let free = free_cells(&is_free, &[CLOCKWISE[2 * quarter]], 3);
        (0..free).for_each(|far| set(percept, 4 * quarter + far));
        if is_seen(&is_free, [0, 0], CLOCKWISE[2 * quarter + 1]) {
            set(percept, 4 * quarter + 3);
        }
    }
}
