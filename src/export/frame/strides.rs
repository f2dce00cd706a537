
/// Counts the free cells that a beam crosses until it meets a wall. The beam repeats the given
/// steps.
fn free_cells(is_free: &impl Fn(i32, i32) -> bool, strides: &[[i32; 2]], most: usize) -> usize {
    let mut at = [0, 0];
    let passes = |stride: &&[i32; 2]| {
        let free = is_seen(is_free, at, **stride);
        at = [at[0] + stride[0], at[1] + stride[1]];
        free
    };
    strides.iter().cycle().take(most).take_while(passes).count()
}
