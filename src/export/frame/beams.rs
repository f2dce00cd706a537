
/// Sixteen beams, clockwise from north: the number of free cells that each goes through, at most seven. The
/// beams between the eight directions go two cells along and one across.
fn set_ring(percept: &mut Percept, is_free: impl Fn(i32, i32) -> bool) {
    for beam in 0..16 {
        // Of the directions beside the beam the one that is no diagonal, and the diagonal.
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
