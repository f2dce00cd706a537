

def is_seen(is_free, start, step):
    """Is the next cell free, and not hidden behind the corner of two walls?"""
    (east, north), (x, y) = start, step
    hidden = x != 0 and y != 0 and not is_free(east + x, north) and not is_free(east, north + y)
    return not hidden and is_free(east + x, north + y)


def ring_from_map(state):
    """The bits of the cells around, as a perfect lidar shows them."""
    return ring(lambda east, north: state(east, north) != WALL)
