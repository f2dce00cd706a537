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

/* East and north of the eight directions, clockwise from north. */
static inline int xcscr_east_of(int direction)
{
    return direction % 4 == 0 ? 0 : direction < 4 ? 1 : -1;
}

static inline int xcscr_north_of(int direction)
{
    return direction % 4 == 2 ? 0 : direction < 2 || direction > 6 ? 1 : -1;
}
