# From a pose to a percept. Lengths are in metres. Poses are in the map frame, whose x, y and yaw of the
# grid's south-western corner are ORIGIN_*. Column 0 is in the west of the grid, row 0 in the north; north is
# the y axis of the map frame, turned by the yaw of the origin.

FREE, WALL, GOAL = "free", "wall", "goal"


def floor(number):
    """The largest whole number that is not above this one, within a billion."""
    if not number > -1e9:
        return -1_000_000_000
    return math.floor(min(number, 1e9))


def grid_from_map(x_m, y_m):
    """A point of the map frame in the grid frame: metres to the east and to the north of the south-western
    corner."""
    x, y = x_m - ORIGIN_X_M, y_m - ORIGIN_Y_M
    return x * ORIGIN_COSINE + y * ORIGIN_SINE, y * ORIGIN_COSINE - x * ORIGIN_SINE


def cell_from_pose(x_m, y_m):
    """The cell that holds a point of the map frame: column and row; None outside of the grid."""
    east, north = (floor(at_m / CELL_SIZE_M) for at_m in grid_from_map(x_m, y_m))
    if not (0 <= east < COLUMNS and 0 <= north < ROWS):
        return None
    return east, ROWS - 1 - north


def pose_of_cell(column, row):
    """The middle of a cell in the map frame: x and y in metres."""
    east_m = (column + 0.5) * CELL_SIZE_M
    north_m = (ROWS - row - 0.5) * CELL_SIZE_M
    return (
        ORIGIN_X_M + (east_m * ORIGIN_COSINE - north_m * ORIGIN_SINE),
        ORIGIN_Y_M + (east_m * ORIGIN_SINE + north_m * ORIGIN_COSINE),
    )
