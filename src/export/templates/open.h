/*
 * A percept in a world from a map, in two layers as in a costmap: which moves are clear of the walls of the
 * map, and what a scan sees on them.
 */

/* The half width of the path in which obstacles are looked for. Beams to the walls beside it end outside. */
#define XCSCR_PATH_M (0.5 * XCSCR_CLEAR_RADIUS_M)
/* The smallest cosine of the angle between a path and a beam along it. */
#define XCSCR_ALONG 0.9
/* The number of beams that must end on a path. */
#define XCSCR_ENOUGH 2

/* Returns the direction of a step, counted clockwise from north. */
static inline int xcscr_direction_of(int east, int north)
{
    static const uint8_t directions[9] = {5, 6, 7, 4, 0, 0, 3, 2, 1};

    return directions[3 * (east + 1) + north + 1];
}

/* Beams of a scan along the eight moves from a cell: how many end on the path, and how many pass its end. */
struct xcscr_scan {
    uint16_t column;
    uint16_t row;
    int is_inside;
    double east_m; /* The pose of the next beam in the grid frame. */
    double north_m;
    double cosine;
    double sine;
    uint16_t ended[8];
    uint16_t passed[8];
};

/* Sets the pose of the next beams in the map frame: metres, cosine and sine of the heading. Returns 0 if the
 * pose is not finite or not in the cell in which the scan began, otherwise 1. */
static inline int xcscr_scan_move(struct xcscr_scan *scan, double x_m, double y_m, double cosine, double sine)
{
    uint16_t column = 0;
    uint16_t row = 0;
    const int is_inside = xcscr_cell_from_pose(x_m, y_m, &column, &row);

    xcscr_grid_from_map(x_m, y_m, &scan->east_m, &scan->north_m);
    scan->cosine = cosine * XCSCR_ORIGIN_COSINE + sine * XCSCR_ORIGIN_SINE;
    scan->sine = sine * XCSCR_ORIGIN_COSINE - cosine * XCSCR_ORIGIN_SINE;
    return is_inside && column == scan->column && row == scan->row;
}

/* Begins a scan at a pose of the map frame, at which the robot stands in the middle of a cell. Returns 0 if
 * the pose is not finite or outside of the grid, otherwise 1. */
static inline int xcscr_scan_begin(struct xcscr_scan *scan, double x_m, double y_m, double cosine, double sine)
{
    int direction;

    for (direction = 0; direction < 8; direction++) {
        scan->ended[direction] = 0;
        scan->passed[direction] = 0;
    }
    scan->is_inside = xcscr_cell_from_pose(x_m, y_m, &scan->column, &scan->row);
    return scan->is_inside && xcscr_scan_move(scan, x_m, y_m, cosine, sine);
}

/* Counts a beam from one point to another, in metres to the east and to the north of the middle of the cell,
 * for the move to the cell so many cells to the east and to the north. */
static inline void xcscr_scan_count(struct xcscr_scan *scan, int east, int north, const double from[2],
                                    const double to[2])
{
    const int direction = xcscr_direction_of(east, north);
    const double root = east != 0 && north != 0 ? 1.4142135623730951 : 1.0;
    const double x = east / root;
    const double y = north / root;
    const double length = root * XCSCR_CELL_SIZE_M;
    const double first = from[0] * x + from[1] * y;
    const double last = to[0] * x + to[1] * y;
    const double first_left = x * from[1] - y * from[0];
    const double last_left = x * to[1] - y * to[0];
    const double along = last - first;
    const double across = last_left - first_left;

    /* The angle between beam and path is too large. */
    if (along <= 0.0 || along * along < XCSCR_ALONG * XCSCR_ALONG * (along * along + across * across)) {
        return;
    }
    if (last < length) {
        if (last > 0.0 && last_left < XCSCR_PATH_M && last_left > -XCSCR_PATH_M) {
            scan->ended[direction]++;
        }
    } else if (first < length) {
        const double left = first_left + (length - first) / along * across;
        if (left < XCSCR_PATH_M && left > -XCSCR_PATH_M) {
            scan->passed[direction]++;
        }
    }
}

/* Adds a beam: cosine and sine of its bearing, counter-clockwise from the heading, and its range in metres,
 * as in a LaserScan message (REP 117). Infinity means that nothing came back. A range below the lidar's
 * shortest one, such as 0 or minus infinity, means that something is too near to be measured. NaN adds
 * nothing. */
static inline void xcscr_scan_add(struct xcscr_scan *scan, double cosine, double sine, double range_m)
{
    const double x = scan->cosine * cosine - scan->sine * sine;
    const double y = scan->sine * cosine + scan->cosine * sine;
    const double east_m = ((double)scan->column + 0.5) * XCSCR_CELL_SIZE_M;
    const double north_m = ((double)XCSCR_ROWS - (double)scan->row - 0.5) * XCSCR_CELL_SIZE_M;
    const double from[2] = {scan->east_m - east_m, scan->north_m - north_m};
    double range = range_m;
    double to[2];
    int east;
    int north;

    if (!(range <= 0.0) && !(range > 0.0)) {
        return;
    }
    range = range < XCSCR_SCAN_NEAREST_M ? XCSCR_SCAN_NEAREST_M : range;
    range = range > 1.0e4 ? XCSCR_SCAN_LOST_RANGE_M : range;
    to[0] = from[0] + range * x;
    to[1] = from[1] + range * y;
    for (east = -1; east <= 1; east++) {
        for (north = -1; north <= 1; north++) {
            if (east != 0 || north != 0) {
                xcscr_scan_count(scan, east, north, from, to);
            }
        }
    }
}

/* Returns 1 if the scan shows an obstacle on the move to the cell so many cells to the east and north. */
static inline int xcscr_scan_is_blocked(const struct xcscr_scan *scan, int east, int north)
{
    const int direction = xcscr_direction_of(east, north);

    return scan->ended[direction] >= XCSCR_ENOUGH && scan->ended[direction] > scan->passed[direction];
}

/* Returns 1 if the move from a cell is clear of the walls of the map. */
static inline int xcscr_is_open(int32_t column, int32_t row, int east, int north)
{
    uint8_t open;

    if (column < 0 || column >= XCSCR_COLUMNS || row < 0 || row >= XCSCR_ROWS) {
        return 0;
    }
    XCSCR_READ(open, xcscr_open[(uint32_t)row * XCSCR_COLUMNS + (uint32_t)column]);
    return open >> xcscr_direction_of(east, north) & 1;
}

/* A cell, and a scan in it or a null pointer. */
struct xcscr_place {
    int32_t column;
    int32_t row;
    const struct xcscr_scan *scan;
};

/* Returns 1 if a step is open from the cell. */
static inline int xcscr_passes(const struct xcscr_place *place, const int8_t step[2])
{
    return xcscr_is_open(place->column, place->row, step[0], step[1])
           && !(place->scan && xcscr_scan_is_blocked(place->scan, step[0], step[1]));
}
