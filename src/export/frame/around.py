

def ring(is_free):
    """The eight cells around, clockwise from north: free 00, wall or hidden 01."""
    return [bit for step in CLOCKWISE for bit in (0, int(not is_seen(is_free, (0, 0), step)))]
