

def ring(is_free):
    """For each main direction, clockwise from north: is it free for one cell, for two, for three, and is the
    diagonal cell free that follows clockwise?"""
    bits = []
    for main, diagonal in zip(CLOCKWISE[::2], CLOCKWISE[1::2]):
        free = free_cells(is_free, [main], 3)
        bits += [int(far < free) for far in range(3)] + [int(is_seen(is_free, (0, 0), diagonal))]
    return bits
