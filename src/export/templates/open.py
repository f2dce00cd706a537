# The eight steps to the east and to the north, clockwise from north.
STEPS = ((0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1))


def open_moves(column, row):
    """A bit for each move from a cell that is clear of the walls of the map, clockwise from north."""
    inside = 0 <= column < COLUMNS and 0 <= row < ROWS
    return OPEN[row * COLUMNS + column] if inside else 0


def percept_from_walls(walls, column, row):
    """The percept of a robot in the middle of a cell: the moves that the map has open, without those that the robot
    sees blocked. `walls` has a bit for each of these, clockwise from north. Of the cells around, open is 00, not open
    01, and a goal 11 if the percept shows goals."""
    moves = open_moves(column, row) & ~walls
    ring = []
    for at, (east, north) in enumerate(STEPS[: RING_BITS // 2]):
        goal = SHOWS_GOALS and (column + east, row - north) in GOALS
        free = moves >> at & 1 == 1
        ring += [int(free and goal), int(not free or goal)]
    return as_percept(ring, column, row)


def percept(x_m, y_m):
    """The percept at a pose of the map frame, in metres. Raises ValueError if the pose is not finite or outside
    of the grid."""
    cell = cell_from_pose(x_m, y_m)
    if cell is None:
        raise ValueError(f"the pose {x_m}, {y_m} is outside of the grid")
    return percept_from_walls(0, *cell)


def open_actions(walls, column, row):
    """The actions that are open from a cell: by the map, and by the walls that the robot sees."""
    moves = open_moves(column, row) & ~walls
    return [at for at in range(len(ACTIONS)) if moves >> 8 // len(ACTIONS) * at & 1 == 1]
