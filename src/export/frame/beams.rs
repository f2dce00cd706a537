
/// Writes sixteen beams, clockwise from north: the number of free cells that each beam crosses, at
/// most seven. A beam between two of the eight directions goes two cells along and one across.
fn set_ring(percept: &mut Percept, is_free: impl Fn(i32, i32) -> bool) {
    for beam in 0..16 {
        // Of the two directions next to the beam: first the straight one, then the diagonal.
        let along = CLOCKWISE[(beam / 2 + usize::from(beam % 4 == 3)) % 8];
        let diagonal = CLOCKWISE[(beam / 2 + usize::from(beam % 4 == 1)) % 8];
        let across = match beam % 2 {
            0 => along,
            _ => [diagonal[0] - along[0], diagonal[1] - along[1]],
        };
        let free = free_cells(&is_free, &[along, across, along], 7);
        set_number(percept, 3 * beam, 3, free as u16);
    }
}
