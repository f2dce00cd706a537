

def ring(is_free):
    """Sixteen beams, clockwise from north: the number of free cells that each goes through, at most seven.
    The beams between the eight directions go two cells along and one across."""
    bits = []
    for beam in range(16):
        # Of the directions beside the beam the one that is no diagonal, and the diagonal.
        along = across = CLOCKWISE[(beam // 2 + (beam % 4 == 3)) % 8]
        if beam % 2 == 1:
            diagonal = CLOCKWISE[(beam // 2 + (beam % 4 == 1)) % 8]
            across = (diagonal[0] - along[0], diagonal[1] - along[1])
        bits += in_binary(free_cells(is_free, [along, across, along], 7), 3)
    return bits
