
# A cell is free with more evidence than this. Evidence of a beam that came back, and of one that did not.
SCAN_FREE, SCAN_HIT, SCAN_LOST = 30, 20, 7
# A beam that is in a cell for less than this, in metres, and this share of its range, says nothing about it.
GRAZE_M, GRAZE_SHARE = 0.15, 0.02
# A beam that ends farther than this from every line of the grid, in metres, is an outlier.
STRAY_M = 0.2
# A range in metres that no lidar has.
MOST_M = 1e4


def axis(origin, direction):
    """A ray along one axis: its cell, the step to the next one, how far along the ray that begins, and how
    far it is from one to the next."""
    cell = floor(origin / CELL_SIZE_M)
    if direction > 0.0:
        per_metre = 1.0 / direction
        return [cell, 1, ((cell + 1.0) * CELL_SIZE_M - origin) * per_metre, CELL_SIZE_M * per_metre]
    if direction < 0.0:
        per_metre = 1.0 / -direction
        return [cell, -1, (origin - cell * CELL_SIZE_M) * per_metre, CELL_SIZE_M * per_metre]
    return [cell, 0, math.inf, math.inf]


class Scan:
    """A percept from a scan: begin with the estimated pose, add the beams one by one, and take the percept.

    A robot that moves meanwhile tells each new pose before the beams that were sent from there, and at last
    the pose in which it stands; a new scan begins where a new action begins. Walls lie on the lines of the
    grid. A cell about which too little is known counts as a wall."""

    def __init__(self, x_m, y_m, cosine, sine):
        """Begins at a pose of the map frame: metres, cosine and sine of the heading."""
        self.move(x_m, y_m, cosine, sine)
        self.middle = self.here
        self.evidence = {}

    def move(self, x_m, y_m, cosine, sine):
        """The robot has moved: the pose of the beams that follow."""
        self.position = grid_from_map(x_m, y_m)
        self.heading = (
            cosine * ORIGIN_COSINE + sine * ORIGIN_SINE,
            sine * ORIGIN_COSINE - cosine * ORIGIN_SINE,
        )
        self.here = tuple(floor(at_m / CELL_SIZE_M) for at_m in self.position)

    def add(self, cosine, sine, range_m):
        """Adds a beam: cosine and sine of its bearing, counter-clockwise from the heading, and its range;
        None, or what is not above 0 or no number, means that nothing came back."""
        came_back = range_m is not None and 0.0 < range_m < MOST_M
        weight, reach = (SCAN_HIT, range_m) if came_back else (SCAN_LOST, SCAN_LOST_RANGE_M)
        graze = GRAZE_M + GRAZE_SHARE * reach
        ahead, aside = self.heading
        x = axis(self.position[0], ahead * cosine - aside * sine)
        y = axis(self.position[1], ahead * sine + aside * cosine)
        entered = 0.0
        # The cells that a ray enters after it left those of the scan do not matter.
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
                # Near a corner it may have ended one cell before or behind.
                if following - left > graze and (entered <= 0.0 or stay > graze):
                    self.mark(x[0], y[0], -SCAN_HIT)
                return
            entered = left

    def percept(self):
        """The percept where the robot stands now."""
        east, north = self.here
        column = min(max(east, 0), COLUMNS - 1)
        row = min(max(ROWS - 1 - north, 0), ROWS - 1)

        def is_free(x, y):
            return self.evidence.get((east + x, north + y), 0) > SCAN_FREE

        return as_percept(ring(is_free), column, row)

    def holds(self, column, row):
        """Is the cell near enough to know something about it?"""
        return abs(column - self.middle[0]) <= SCAN_REACH and abs(row - self.middle[1]) <= SCAN_REACH

    def mark(self, column, row, evidence):
        """Adds evidence that a cell is free, or is a wall where it is negative."""
        if self.holds(column, row):
            self.evidence[column, row] = self.evidence.get((column, row), 0) + evidence


def percept_from_scan(x_m, y_m, heading_rad, ranges, angle_min, angle_increment):
    """The percept of a whole scan that was taken at rest, such as a LaserScan message of ROS: the first
    bearing and the step to the next one in radians, counter-clockwise from the heading."""
    scan = Scan(x_m, y_m, math.cos(heading_rad), math.sin(heading_rad))
    for number, range_m in enumerate(ranges):
        bearing = angle_min + number * angle_increment
        scan.add(math.cos(bearing), math.sin(bearing), range_m)
    return scan.percept()
