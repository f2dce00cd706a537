def ring(is_free):
    """The cells around the robot, clockwise from north: free 00, wall 01. A cell behind the corner of two walls is
    hidden, and counts as a wall."""
    result = []
    for east, north in CLOCKWISE:
        hidden = east != 0 and north != 0 and not is_free(east, 0) and not is_free(0, north)
        result += [0, int(hidden or not is_free(east, north))]
    return result


def ring_from_map(state):
    """The bits of the cells around, as a perfect lidar shows them."""
    return ring(lambda east, north: state(east, north) != WALL)
