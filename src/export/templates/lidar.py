def ring(walls):
    """The cells around the robot, clockwise from north: free 00, wall 01. Bit i of `walls` is set if cell i is a
    wall. A cell behind the corner of two walls is hidden, and counts as a wall."""
    is_wall = [walls >> at & 1 == 1 for at in range(8)]
    result = []
    for at in range(8):
        hidden = at % 2 == 1 and is_wall[at - 1] and is_wall[(at + 1) % 8]
        result += [0, int(hidden or is_wall[at])]
    return result


def percept_from_walls(walls, column, row):
    """The percept of a robot in the middle of a cell that sees these walls: a bit for each of the eight cells
    around, clockwise from north."""
    return as_percept(ring(walls), column, row)


def ring_from_map(state):
    """The bits of the cells around, as a perfect lidar shows them."""
    return ring(sum(1 << at for at, step in enumerate(CLOCKWISE) if state(*step) == WALL))
