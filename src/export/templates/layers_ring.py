def ring(passes, column, row):
    """The bits of the cells around, clockwise from north: open 00, not open 01, goal 11 if it shows."""
    result = []
    for step in STEPS[: RING_BITS // 2]:
        goal = SHOWS_GOALS and (column + step[0], row - step[1]) in GOALS
        free = passes(step)
        result += [int(free and goal), int(not free or goal)]
    return result
