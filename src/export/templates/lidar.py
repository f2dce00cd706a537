def is_seen(is_free, start, step):
    """Is the next cell free, and not hidden behind the corner of two walls?"""
    (east, north), (x, y) = start, step
    hidden = x != 0 and y != 0 and not is_free(east + x, north) and not is_free(east, north + y)
    return not hidden and is_free(east + x, north + y)


def free_cells(is_free, along, across, most):
    """Counts the cells that a ray goes through until it meets a wall. Every third step, from the second on,
    is across."""
    east = north = 0
    for count in range(most):
        x, y = across if count % 3 == 1 else along
        if not is_seen(is_free, (east, north), (x, y)):
            return count
        east, north = east + x, north + y
    return most


def ring(is_free):
    """The bits that the rays show, one ray after the other."""
    result = []
    for along, across, bits, codes in RAYS:
        free = free_cells(is_free, along, across, len(codes) - 1)
        result += in_binary(codes[free], bits)
    return result


def ring_from_map(state):
    """The bits of the cells around, as a perfect lidar shows them."""
    return ring(lambda east, north: state(east, north) != WALL)
