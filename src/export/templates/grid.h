/*
 * From a pose to a percept. Lengths are in metres. Poses are in the map frame, whose x, y and yaw of the
 * grid's south-western corner are XCSCR_ORIGIN_*. Column 0 is in the west of the grid, row 0 in the north;
 * north is the y axis of the map frame, turned by the yaw of the origin. What a program does not call is
 * not compiled into it.
 */

/* Returns the largest whole number that is not above this one, within a billion. */
static inline int32_t xcscr_floor(double number)
{
    int32_t whole;

    if (!(number > -1.0e9)) {
        return -1000000000;
    }
    if (number > 1.0e9) {
        return 1000000000;
    }
    whole = (int32_t)number;
    return (double)whole > number ? whole - 1 : whole;
}

/* Converts a point from the map frame to the grid frame: metres to the east and to the north of the
 * south-western corner. */
static inline void xcscr_grid_from_map(double x_m, double y_m, double *east_m, double *north_m)
{
    const double x = x_m - XCSCR_ORIGIN_X_M;
    const double y = y_m - XCSCR_ORIGIN_Y_M;

    *east_m = x * XCSCR_ORIGIN_COSINE + y * XCSCR_ORIGIN_SINE;
    *north_m = y * XCSCR_ORIGIN_COSINE - x * XCSCR_ORIGIN_SINE;
}

/* Finds the cell that holds a point of the map frame. Returns 0 outside of the grid, otherwise 1. */
static inline int xcscr_cell_from_pose(double x_m, double y_m, uint16_t *column, uint16_t *row)
{
    double east_m;
    double north_m;
    int32_t east;
    int32_t north;

    xcscr_grid_from_map(x_m, y_m, &east_m, &north_m);
    east = xcscr_floor(east_m / XCSCR_CELL_SIZE_M);
    north = xcscr_floor(north_m / XCSCR_CELL_SIZE_M);
    if (east < 0 || east >= XCSCR_COLUMNS || north < 0 || north >= XCSCR_ROWS) {
        return 0;
    }
    *column = (uint16_t)east;
    *row = (uint16_t)(XCSCR_ROWS - 1 - north);
    return 1;
}

/* Finds the middle of a cell in the map frame. */
static inline void xcscr_pose_of_cell(uint16_t column, uint16_t row, double *x_m, double *y_m)
{
    const double east_m = ((double)column + 0.5) * XCSCR_CELL_SIZE_M;
    const double north_m = ((double)XCSCR_ROWS - (double)row - 0.5) * XCSCR_CELL_SIZE_M;

    *x_m = XCSCR_ORIGIN_X_M + (east_m * XCSCR_ORIGIN_COSINE - north_m * XCSCR_ORIGIN_SINE);
    *y_m = XCSCR_ORIGIN_Y_M + (east_m * XCSCR_ORIGIN_SINE + north_m * XCSCR_ORIGIN_COSINE);
}

/* States of a cell. */
#define XCSCR_CELL_FREE 0
#define XCSCR_CELL_WALL 1
#define XCSCR_CELL_GOAL 2

/* Returns the state of a cell of the grid; `user` is the pointer that xcscr_percept_from_map was given. */
typedef uint8_t (*xcscr_look_up)(void *user, uint16_t column, uint16_t row);

/* An occupancy map, and the cell in which the robot stands. */
struct xcscr_map {
    xcscr_look_up look_up;
    void *user;
    int32_t column;
    int32_t row;
};

/* Returns the state of the cell so many cells to the east and to the north of the robot; outside of the
 * grid are walls. */
static inline uint8_t xcscr_state_at(const struct xcscr_map *map, int east, int north)
{
    int32_t column = map->column + east;
    int32_t row = map->row - north;

    if (XCSCR_WRAPS) {
        column = (column % XCSCR_COLUMNS + XCSCR_COLUMNS) % XCSCR_COLUMNS;
        row = (row % XCSCR_ROWS + XCSCR_ROWS) % XCSCR_ROWS;
    }
    if (column < 0 || column >= XCSCR_COLUMNS || row < 0 || row >= XCSCR_ROWS) {
        return XCSCR_CELL_WALL;
    }
    return map->look_up(map->user, (uint16_t)column, (uint16_t)row);
}

/* Sets a bit of a percept; bits that the policy does not look at are left out. */
static inline void xcscr_set(xcscr_word *percept, int bit)
{
    const int word = bit / XCSCR_WORD_BITS;

    if (word < XCSCR_WORDS) {
        percept[word] = (xcscr_word)(percept[word] | (1u << bit % XCSCR_WORD_BITS));
    }
}

/* Writes a number into so many bits of a percept, the highest first. */
static inline void xcscr_set_number(xcscr_word *percept, int first, int bits, int32_t number)
{
    int bit;

    for (bit = 0; bit < bits; bit++) {
        if ((number >> (bits - 1 - bit) & 1) != 0) {
            xcscr_set(percept, first + bit);
        }
    }
}

/* Clears a percept, and writes column and row behind the bits of the cells around, if it has them. */
static inline void xcscr_begin_percept(xcscr_word *percept, int32_t column, int32_t row)
{
    int word;

    for (word = 0; word < XCSCR_WORDS; word++) {
        percept[word] = 0;
    }
    xcscr_set_number(percept, XCSCR_RING_BITS, XCSCR_COLUMN_BITS, column);
    xcscr_set_number(percept, XCSCR_RING_BITS + XCSCR_COLUMN_BITS, XCSCR_ROW_BITS, row);
}

static inline void xcscr_set_ring_from_map(xcscr_word *percept, const struct xcscr_map *map);

/* Writes the percept of a robot in the middle of a cell. */
static inline void xcscr_percept_from_map(uint16_t column, uint16_t row, xcscr_look_up look_up, void *user,
                                          xcscr_word *percept)
{
    struct xcscr_map map;

    map.look_up = look_up;
    map.user = user;
    map.column = column;
    map.row = row;
    xcscr_begin_percept(percept, column, row);
    xcscr_set_ring_from_map(percept, &map);
}
