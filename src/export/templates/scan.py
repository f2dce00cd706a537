# A cell is free if its evidence exceeds SCAN_FREE. SCAN_HIT is the evidence of a beam that came back,
# SCAN_LOST the evidence of a beam that did not.
SCAN_FREE, SCAN_HIT, SCAN_LOST = 30, 20, 7
# A beam gives no evidence about a cell in which it travels less than GRAZE_M metres plus GRAZE_SHARE of its
# range. In cells of less than 1 m, GRAZE_M shrinks in proportion.
GRAZE_M, GRAZE_SHARE = 0.15 * min(CELL_SIZE_M, 1.0), 0.02
# A beam that ends more than this from every line of the grid, in metres, is an outlier.
STRAY_M = 0.2 * min(CELL_SIZE_M, 1.0)
# From this range in metres on, nothing came back.
MOST_M = 1e4


def axis(origin, direction):
    """A ray along one axis: its cell, the step to the next cell, the distance along the ray to the next cell,
    and the distance between two crossings."""
    cell = floor(origin / CELL_SIZE_M)
    if direction > 0.0:
        per_metre = 1.0 / direction
        return [cell, 1, ((cell + 1.0) * CELL_SIZE_M - origin) * per_metre, CELL_SIZE_M * per_metre]
    if direction < 0.0:
        per_metre = 1.0 / -direction
        return [cell, -1, (origin - cell * CELL_SIZE_M) * per_metre, CELL_SIZE_M * per_metre]
    return [cell, 0, math.inf, math.inf]


class Scan:
    """A percept from a scan. Begin at the estimated pose, add the beams one by one, and take the percept.

    Begin a new scan with each action. If the robot moves during the scan, call move with the pose of each
    beam before adding the beam, and at the end with the pose at which the robot stands. Walls lie on the
    lines of the grid. A cell with too little evidence counts as a wall."""

    def __init__(self, x_m, y_m, cosine, sine):
        """Begins a scan at a pose of the map frame: metres, cosine and sine of the heading."""
        self.move(x_m, y_m, cosine, sine)
        self.middle = self.here
        self.evidence = {}

    def move(self, x_m, y_m, cosine, sine):
        """Sets the pose of the next beams in the map frame: metres, cosine and sine of the heading."""
        self.position = grid_from_map(x_m, y_m)
        self.heading = (
            cosine * ORIGIN_COSINE + sine * ORIGIN_SINE,
            sine * ORIGIN_COSINE - cosine * ORIGIN_SINE,
        )
        self.here = tuple(floor(at_m / CELL_SIZE_M) for at_m in self.position)

    def add(self, cosine, sine, range_m):
        """Adds a beam: cosine and sine of its bearing, counter-clockwise from the heading, and its range in
        metres, as in a LaserScan message (REP 117). Infinity or None means that nothing came back. A range
        below the lidar's shortest one, such as 0 or minus infinity, means that something is too near to be
        measured. NaN adds nothing."""
        if range_m is not None and math.isnan(range_m):
            return
        came_back = range_m is not None and range_m < MOST_M
        if came_back:
            weight, reach = SCAN_HIT, max(range_m, SCAN_NEAREST_M)
        else:
            weight, reach = SCAN_LOST, SCAN_LOST_RANGE_M
        graze = GRAZE_M + GRAZE_SHARE * reach
        ahead, aside = self.heading
        x = axis(self.position[0], ahead * cosine - aside * sine)
        y = axis(self.position[1], ahead * sine + aside * cosine)
        entered = 0.0
        # Cells beyond those of the scan do not matter.
        while self.holds(x[0], y[0]):
            column, row = x[0], y[0]
            crossed = x if x[2] < y[2] else y
            left = crossed[2]
            if not left <= reach + STRAY_M:
                return
            crossed[0] += crossed[1]
            crossed[2] += crossed[3]
            following = x[2] if x[2] < y[2] else y[2]
            ends = came_back and reach < (left + following) / 2.0
            if ends and abs(left - reach) > STRAY_M:
                return
            stay = left - entered
            if stay > graze:
                self.mark(column, row, weight)
            if ends:
                # Near a corner the beam may have ended in the cell before or behind.
                if following - left > graze and (entered <= 0.0 or stay > graze):
                    self.mark(x[0], y[0], -SCAN_HIT)
                return
            entered = left

    def percept(self):
        """Returns the percept at the current pose."""
        east, north = self.here
        column = min(max(east, 0), COLUMNS - 1)
        row = min(max(ROWS - 1 - north, 0), ROWS - 1)

        def is_free(x, y):
            return self.evidence.get((east + x, north + y), 0) > SCAN_FREE

        return as_percept(ring(is_free), column, row)

    def holds(self, column, row):
        """Returns True if the scan stores evidence about the cell."""
        return abs(column - self.middle[0]) <= SCAN_REACH and abs(row - self.middle[1]) <= SCAN_REACH

    def mark(self, column, row, evidence):
        """Adds evidence that a cell is free; negative evidence means a wall."""
        if self.holds(column, row):
            self.evidence[column, row] = self.evidence.get((column, row), 0) + evidence


def percept_from_scan(x_m, y_m, heading_rad, ranges, angle_min, angle_increment):
    """Returns the percept of a whole scan taken at rest, such as a LaserScan message of ROS. Angles are in
    radians, counter-clockwise from the heading."""
    scan = Scan(x_m, y_m, math.cos(heading_rad), math.sin(heading_rad))
    for number, range_m in enumerate(ranges):
        bearing = angle_min + number * angle_increment
        scan.add(math.cos(bearing), math.sin(bearing), range_m)
    return scan.percept()
