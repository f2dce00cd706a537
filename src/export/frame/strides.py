

def free_cells(is_free, strides, most):
    """Counts the cells that a beam goes through until it meets a wall, with these steps in turn."""
    east = north = 0
    for count in range(most):
        x, y = strides[count % len(strides)]
        if not is_seen(is_free, (east, north), (x, y)):
            return count
        east, north = east + x, north + y
    return most
