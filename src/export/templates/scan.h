/*
 * A percept from a scan. Begin at the estimated pose, add the beams one by one, and take the percept.
 * Begin a new scan with each action. If the robot moves during the scan, call xcscr_scan_move with the pose
 * of each beam before adding the beam, and at the end with the pose at which the robot stands.
 * Walls lie on the lines of the grid. A cell with too little evidence counts as a wall.
 */
#define XCSCR_SCAN_SIDE (2 * XCSCR_SCAN_REACH + 1)
/* A cell is free if its evidence exceeds FREE. HIT is the evidence of a beam that came back, LOST the
 * evidence of a beam that did not. */
#define XCSCR_SCAN_FREE 30
#define XCSCR_SCAN_HIT 20
#define XCSCR_SCAN_LOST 7
#define XCSCR_SCAN_MOST 1000000000
/* A beam gives no evidence about a cell in which it travels less than GRAZE_M metres plus GRAZE_SHARE of its
 * range. A beam that ends more than STRAY_M metres from every line is an outlier. In cells of less than 1 m,
 * GRAZE_M and STRAY_M shrink in proportion. */
#define XCSCR_SCAN_GRAZE_M 0.15
#define XCSCR_SCAN_GRAZE_SHARE 0.02
#define XCSCR_SCAN_STRAY_M 0.2
/* The range of a beam that did not come back; every range from MOST_M metres on means the same. */
#define XCSCR_NOTHING 1.0e30
#define XCSCR_SCAN_MOST_M 1.0e4
#define XCSCR_SCAN_NEVER 1.0e30

/* Evidence about the cells around a robot; columns count to the east, rows to the north. */
struct xcscr_scan {
    double east_m; /* the pose of the next beams in the grid frame */
    double north_m;
    double cosine;
    double sine;
    int32_t middle[2]; /* the cell in which the scan began */
    int32_t here[2];   /* the cell of the pose */
    int32_t evidence[XCSCR_SCAN_SIDE][XCSCR_SCAN_SIDE];
};

/* Sets the pose of the next beams in the map frame: metres, cosine and sine of the heading. */
static inline void xcscr_scan_move(struct xcscr_scan *scan, double x_m, double y_m, double cosine, double sine)
{
    xcscr_grid_from_map(x_m, y_m, &scan->east_m, &scan->north_m);
    scan->cosine = cosine * XCSCR_ORIGIN_COSINE + sine * XCSCR_ORIGIN_SINE;
    scan->sine = sine * XCSCR_ORIGIN_COSINE - cosine * XCSCR_ORIGIN_SINE;
    scan->here[0] = xcscr_floor(scan->east_m / XCSCR_CELL_SIZE_M);
    scan->here[1] = xcscr_floor(scan->north_m / XCSCR_CELL_SIZE_M);
}

/* Begins a scan at a pose of the map frame and clears all evidence. */
static inline void xcscr_scan_begin(struct xcscr_scan *scan, double x_m, double y_m, double cosine, double sine)
{
    int x;
    int y;

    xcscr_scan_move(scan, x_m, y_m, cosine, sine);
    scan->middle[0] = scan->here[0];
    scan->middle[1] = scan->here[1];
    for (x = 0; x < XCSCR_SCAN_SIDE; x++) {
        for (y = 0; y < XCSCR_SCAN_SIDE; y++) {
            scan->evidence[x][y] = 0;
        }
    }
}

/* Returns 1 if the scan stores evidence about the cell. */
static inline int xcscr_scan_holds(const struct xcscr_scan *scan, int32_t column, int32_t row)
{
    const int32_t x = column - scan->middle[0];
    const int32_t y = row - scan->middle[1];

    return x >= -XCSCR_SCAN_REACH && x <= XCSCR_SCAN_REACH && y >= -XCSCR_SCAN_REACH && y <= XCSCR_SCAN_REACH;
}

static inline void xcscr_scan_mark(struct xcscr_scan *scan, int32_t column, int32_t row, int32_t evidence)
{
    int32_t *known;

    if (xcscr_scan_holds(scan, column, row)) {
        known = &scan->evidence[column - scan->middle[0] + XCSCR_SCAN_REACH]
                               [row - scan->middle[1] + XCSCR_SCAN_REACH];
        if (*known > -XCSCR_SCAN_MOST && *known < XCSCR_SCAN_MOST) {
            *known += evidence;
        }
    }
}

/* A ray along one axis. */
struct xcscr_axis {
    int32_t cell;
    int32_t step;
    double next;  /* how far along the ray the next cell begins */
    double every; /* from one cell to the next */
};

static inline struct xcscr_axis xcscr_axis(double origin, double direction)
{
    struct xcscr_axis axis = {0, 0, XCSCR_SCAN_NEVER, XCSCR_SCAN_NEVER};

    axis.cell = xcscr_floor(origin / XCSCR_CELL_SIZE_M);
    if (direction > 0.0) {
        const double per_metre = 1.0 / direction;
        axis.step = 1;
        axis.next = (((double)axis.cell + 1.0) * XCSCR_CELL_SIZE_M - origin) * per_metre;
        axis.every = XCSCR_CELL_SIZE_M * per_metre;
    } else if (direction < 0.0) {
        const double per_metre = 1.0 / -direction;
        axis.step = -1;
        axis.next = (origin - (double)axis.cell * XCSCR_CELL_SIZE_M) * per_metre;
        axis.every = XCSCR_CELL_SIZE_M * per_metre;
    }
    return axis;
}

static inline double xcscr_nearer(const struct xcscr_axis *x, const struct xcscr_axis *y)
{
    return x->next < y->next ? x->next : y->next;
}

static inline void xcscr_cross(struct xcscr_axis *axis)
{
    axis->cell += axis->step;
    axis->next += axis->every;
}

/* Adds a beam: cosine and sine of its bearing, counter-clockwise from the heading, and its range in metres,
 * as in a LaserScan message (REP 117). Infinity or XCSCR_NOTHING means that nothing came back. A range below
 * the lidar's shortest one, such as 0 or minus infinity, means that something is too near to be measured.
 * NaN adds nothing. */
static inline void xcscr_scan_add(struct xcscr_scan *scan, double cosine, double sine, double range_m)
{
    const int came_back = range_m < XCSCR_SCAN_MOST_M;
    const int32_t weight = came_back ? XCSCR_SCAN_HIT : XCSCR_SCAN_LOST;
    const double measured = range_m > XCSCR_SCAN_NEAREST_M ? range_m : XCSCR_SCAN_NEAREST_M;
    const double range = came_back ? measured : XCSCR_SCAN_LOST_RANGE_M;
    const double scale = XCSCR_CELL_SIZE_M < 1.0 ? XCSCR_CELL_SIZE_M : 1.0;
    const double graze = XCSCR_SCAN_GRAZE_M * scale + XCSCR_SCAN_GRAZE_SHARE * range;
    const double stray = XCSCR_SCAN_STRAY_M * scale;
    struct xcscr_axis x = xcscr_axis(scan->east_m, scan->cosine * cosine - scan->sine * sine);
    struct xcscr_axis y = xcscr_axis(scan->north_m, scan->cosine * sine + scan->sine * cosine);
    double entered = 0.0;

    if (range_m != range_m) {
        return;
    }
    /* Cells beyond those of the scan do not matter. */
    while (xcscr_scan_holds(scan, x.cell, y.cell)) {
        const int32_t column = x.cell;
        const int32_t row = y.cell;
        const double left = xcscr_nearer(&x, &y);
        const double stay = left - entered;
        double following;
        int ends;
        if (!(left <= range + stray)) {
            return;
        }
        xcscr_cross(x.next < y.next ? &x : &y);
        following = xcscr_nearer(&x, &y);
        ends = came_back && range < (left + following) / 2.0;
        if (ends && (left - range > stray || range - left > stray)) {
            return;
        }
        if (stay > graze) {
            xcscr_scan_mark(scan, column, row, weight);
        }
        if (ends) {
            /* Near a corner the beam may have ended in the cell before or behind. */
            if (following - left > graze && (entered <= 0.0 || stay > graze)) {
                xcscr_scan_mark(scan, x.cell, y.cell, -XCSCR_SCAN_HIT);
            }
            return;
        }
        entered = left;
    }
}

/* Returns 1 if the scan shows that the cell so many cells east and north of the robot is free. */
static inline int xcscr_scan_is_free(const void *seen, int east, int north)
{
    const struct xcscr_scan *scan = (const struct xcscr_scan *)seen;
    const int32_t column = scan->here[0] + east;
    const int32_t row = scan->here[1] + north;

    return xcscr_scan_holds(scan, column, row)
           && scan->evidence[column - scan->middle[0] + XCSCR_SCAN_REACH]
                            [row - scan->middle[1] + XCSCR_SCAN_REACH] > XCSCR_SCAN_FREE;
}

/* Writes the percept at the current pose. */
static inline void xcscr_scan_percept(const struct xcscr_scan *scan, xcscr_word *percept)
{
    int32_t column = scan->here[0];
    int32_t row = XCSCR_ROWS - 1 - scan->here[1];

    column = column < 0 ? 0 : column < XCSCR_COLUMNS ? column : XCSCR_COLUMNS - 1;
    row = row < 0 ? 0 : row < XCSCR_ROWS ? row : XCSCR_ROWS - 1;
    xcscr_begin_percept(percept, column, row);
    xcscr_set_ring(percept, xcscr_scan_is_free, scan);
}
