# East and north of the eight directions, clockwise from north.
CLOCKWISE = [(0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1)]


def percept_from_map(column, row, look_up):
    """The percept of a robot in the middle of a cell; look_up(column, row) returns FREE, WALL or GOAL for a
    cell of the grid."""

    def state(east, north):
        """The state of the cell so many cells to the east and to the north; outside of the grid are walls."""
        at, below = column + east, row - north
        if WRAPS:
            at, below = at % COLUMNS, below % ROWS
        inside = 0 <= at < COLUMNS and 0 <= below < ROWS
        return look_up(at, below) if inside else WALL

    return as_percept(ring_from_map(state), column, row)
