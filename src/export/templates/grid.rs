// Conversion from a pose to a percept. Lengths are in metres. Poses are in the map frame. The
// constants `ORIGIN_*` are the x, y and yaw of the grid's south-western corner in the map frame.
// Column 0 is in the west of the grid, row 0 in the north. North is the y axis of the map frame,
// turned by the yaw of the origin.

/// Returns the largest whole number that is not greater than `number`, limited to a billion.
fn floor(number: f64) -> i32 {
    if number.is_nan() || number <= -1e9 {
        return -1_000_000_000;
    }
    let whole = number.min(1e9) as i32;
    if f64::from(whole) > number {
        whole - 1
    } else {
        whole
    }
}

/// Converts a point from the map frame to the grid frame: metres to the east and to the north of the
/// south-western corner.
fn grid_from_map(x_m: f64, y_m: f64) -> [f64; 2] {
    let (x, y) = (x_m - ORIGIN_X_M, y_m - ORIGIN_Y_M);
    [
        x * ORIGIN_COSINE + y * ORIGIN_SINE,
        y * ORIGIN_COSINE - x * ORIGIN_SINE,
    ]
}

/// Returns the column and row of the cell that contains a point of the map frame; `None` outside of
/// the grid.
pub fn cell_from_pose(x_m: f64, y_m: f64) -> Option<(u16, u16)> {
    let [east, north] = grid_from_map(x_m, y_m).map(|at_m| floor(at_m / CELL_SIZE_M));
    let is_inside =
        (0..i32::from(COLUMNS)).contains(&east) && (0..i32::from(ROWS)).contains(&north);
    is_inside.then(|| (east as u16, ROWS - 1 - north as u16))
}

/// Returns the centre of a cell in the map frame: x and y in metres.
pub fn pose_of_cell(column: u16, row: u16) -> (f64, f64) {
    let east_m = (f64::from(column) + 0.5) * CELL_SIZE_M;
    let north_m = (f64::from(ROWS) - f64::from(row) - 0.5) * CELL_SIZE_M;
    (
        ORIGIN_X_M + (east_m * ORIGIN_COSINE - north_m * ORIGIN_SINE),
        ORIGIN_Y_M + (east_m * ORIGIN_SINE + north_m * ORIGIN_COSINE),
    )
}

/// The state of a cell.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum CellState {
    /// Free; a robot can stand there.
    Free,
    /// Occupied.
    Wall,
    /// A goal; a robot can stand there.
    Goal,
}

/// Returns the state of the cell at an offset to the east and to the north of a robot in the cell
/// (column, row). Everything outside of the grid is a wall.
fn state_at(
    look_up: &impl Fn(u16, u16) -> CellState,
    [column, row]: [u16; 2],
    east: i32,
    north: i32,
) -> CellState {
    let along = |from: u16, step: i32, size: u16| {
        let (to, size) = (i32::from(from) + step, i32::from(size));
        let to = if WRAPS { to.rem_euclid(size) } else { to };
        (0..size).contains(&to).then_some(to as u16)
    };
    match (along(column, east, COLUMNS), along(row, -north, ROWS)) {
        (Some(column), Some(row)) => look_up(column, row),
        _ => CellState::Wall,
    }
}

/// Writes a number into `bits` bits of a percept, the highest first.
fn set_number(percept: &mut Percept, first: usize, bits: usize, number: u16) {
    for bit in (0..bits).filter(|bit| number >> (bits - 1 - bit) & 1 == 1) {
        set(percept, first + bit);
    }
}

/// Returns a percept with only the column and the row. They follow the bits of the surrounding
/// cells, if the percept has these.
fn percept_in(column: u16, row: u16) -> Percept {
    let mut percept = EMPTY;
    set_number(&mut percept, RING_BITS, COLUMN_BITS, column);
    set_number(&mut percept, RING_BITS + COLUMN_BITS, ROW_BITS, row);
    percept
}

/// Returns the percept of a robot in the middle of a cell. `look_up` returns the state of a cell
/// (column, row) of the grid.
pub fn percept_from_map(column: u16, row: u16, look_up: impl Fn(u16, u16) -> CellState) -> Percept {
    let mut percept = percept_in(column, row);
    set_ring_from_map(&mut percept, |east, north| {
        state_at(&look_up, [column, row], east, north)
    });
    percept
}
