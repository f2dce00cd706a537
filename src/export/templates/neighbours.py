def ring_from_map(state):
    """The cells around the robot, clockwise from north: free 00, wall 01, goal 11."""
    states = [state(east, north) for east, north in CLOCKWISE[: RING_BITS // 2]]
    return [bit for one in states for bit in (int(one == GOAL), int(one != FREE))]
