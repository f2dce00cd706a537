# A percept in a world from a map, in two layers as in a costmap: which moves are clear of the walls of the
# map, and what a scan sees on them.

# The eight steps to the east and to the north, clockwise from north.
STEPS = ((0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1))
# The half width of the path in which obstacles are looked for. Beams to the walls beside it end outside.
PATH_M = 0.5 * CLEAR_RADIUS_M
# The smallest cosine of the angle between a path and a beam along it.
ALONG = 0.9
# The number of beams that must end on a path.
ENOUGH = 2


def is_open(column, row, step):
    """Is the move from a cell clear of the walls of the map?"""
    inside = 0 <= column < COLUMNS and 0 <= row < ROWS
    return inside and OPEN[row * COLUMNS + column] >> STEPS.index(step) & 1 == 1


class Scan:
    """A scan of a robot that stands in a cell. Begin at the estimated pose, and add the beams one by one."""

    def __init__(self, x_m, y_m, cosine, sine):
        """Begins a scan at a pose of the map frame: metres, cosine and sine of the heading. Raises ValueError
        if the pose is not finite or outside of the grid."""
        self.cell = cell_from_pose(x_m, y_m)
        if self.cell is None:
            raise ValueError(f"the pose {x_m}, {y_m} is outside of the grid")
        self.ended = dict.fromkeys(STEPS, 0)
        self.passed = dict.fromkeys(STEPS, 0)
        self.move(x_m, y_m, cosine, sine)

    def move(self, x_m, y_m, cosine, sine):
        """Sets the pose of the next beams in the map frame: metres, cosine and sine of the heading."""
        column, row = self.cell
        east_m, north_m = grid_from_map(x_m, y_m)
        middle_m = (column + 0.5) * CELL_SIZE_M, (ROWS - row - 0.5) * CELL_SIZE_M
        self.position = east_m - middle_m[0], north_m - middle_m[1]
        self.heading = (
            cosine * ORIGIN_COSINE + sine * ORIGIN_SINE,
            sine * ORIGIN_COSINE - cosine * ORIGIN_SINE,
        )

    def add(self, cosine, sine, range_m):
        """Adds a beam: cosine and sine of its bearing, counter-clockwise from the heading, and its range in
        metres, as in a LaserScan message (REP 117). Infinity or None means that nothing came back. A range
        below the lidar's shortest one, such as 0 or minus infinity, means that something is too near to be
        measured. NaN adds nothing."""
        if range_m is not None and math.isnan(range_m):
            return
        if range_m is None or range_m > 1e4:
            range_m = SCAN_LOST_RANGE_M
        range_m = max(range_m, SCAN_NEAREST_M)
        ahead, left = self.heading
        x, y = self.position
        end = (x + range_m * (ahead * cosine - left * sine), y + range_m * (left * cosine + ahead * sine))
        for step in STEPS:
            self.count(step, self.position, end)

    def count(self, step, start, end):
        """Counts a beam from one point to another, relative to the middle of the cell, for a move."""
        root = math.sqrt(2.0) if all(step) else 1.0
        x, y = step[0] / root, step[1] / root
        length = root * CELL_SIZE_M
        (first, first_left), (last, last_left) = (
            (at[0] * x + at[1] * y, x * at[1] - y * at[0]) for at in (start, end)
        )
        along, across = last - first, last_left - first_left
        # The angle between beam and path is too large.
        if along <= 0.0 or along**2 < ALONG**2 * (along**2 + across**2):
            return
        if last < length:
            self.ended[step] += last > 0.0 and abs(last_left) < PATH_M
        elif first < length:
            self.passed[step] += abs(first_left + (length - first) / along * across) < PATH_M

    def is_blocked(self, step):
        """Does the scan show an obstacle on a move?"""
        return self.ended[step] >= ENOUGH and self.ended[step] > self.passed[step]

    def open_actions(self):
        """The actions that the scan shows to be open."""
        column, row = self.cell
        steps = STEPS[:: 8 // len(ACTIONS)]
        return [at for at, step in enumerate(steps) if passes(column, row, self, step)]

    def percept(self):
        """The percept of the robot."""
        return percept_of_cell(*self.cell, self)


def passes(column, row, scan, step):
    """Is a step open from a cell?"""
    return is_open(column, row, step) and not (scan is not None and scan.is_blocked(step))


def percept_of_cell(column, row, scan=None):
    """The percept of a robot in the middle of a cell; without a scan, that of the map."""
    return as_percept(ring(lambda step: passes(column, row, scan, step), column, row), column, row)


def percept(x_m, y_m, scan=None):
    """The percept at a pose of the map frame, in metres. Raises ValueError if the pose is not finite or outside
    of the grid."""
    cell = cell_from_pose(x_m, y_m)
    if cell is None:
        raise ValueError(f"the pose {x_m}, {y_m} is outside of the grid")
    return percept_of_cell(*cell, scan)


def percept_from_scan(x_m, y_m, heading_rad, ranges, angle_min, angle_increment):
    """Returns the percept of a whole scan taken at rest, such as a LaserScan message of ROS. Angles are in
    radians, counter-clockwise from the heading."""
    scan = Scan(x_m, y_m, math.cos(heading_rad), math.sin(heading_rad))
    for number, range_m in enumerate(ranges):
        bearing = angle_min + number * angle_increment
        scan.add(math.cos(bearing), math.sin(bearing), range_m)
    return scan.percept()
