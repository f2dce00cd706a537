/// Returns true if the next cell is free, and not hidden behind the corner of two walls.
fn is_seen(is_free: &impl Fn(i32, i32) -> bool, [east, north]: [i32; 2], [x, y]: [i32; 2]) -> bool {
    let hidden = x != 0 && y != 0 && !is_free(east + x, north) && !is_free(east, north + y);
    !hidden && is_free(east + x, north + y)
}

/// Counts the free cells that a ray crosses until it meets a wall. Every third step, from the second
/// on, is `across`.
fn free_cells(is_free: &impl Fn(i32, i32) -> bool, ray: &Ray) -> usize {
    let mut at = [0, 0];
    let passes = |step: &[i32; 2]| {
        let free = is_seen(is_free, at, *step);
        at = [at[0] + step[0], at[1] + step[1]];
        free
    };
    let steps = [ray.along, ray.across, ray.along].into_iter().cycle();
    steps.take(ray.codes.len() - 1).take_while(passes).count()
}

/// Writes what the rays show, one after the other.
fn set_ring(percept: &mut Percept, is_free: impl Fn(i32, i32) -> bool) {
    let mut first = 0;
    for ray in &RAYS {
        set_number(
            percept,
            first,
            ray.bits,
            ray.codes[free_cells(&is_free, ray)],
        );
        first += ray.bits;
    }
}

fn set_ring_from_map(percept: &mut Percept, state: impl Fn(i32, i32) -> CellState) {
    set_ring(percept, |east, north| state(east, north) != CellState::Wall);
}
