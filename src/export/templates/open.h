/* Returns a bit for each move from a cell that is clear of the walls of the map, clockwise from north. */
static inline uint8_t xcscr_open_moves(int32_t column, int32_t row)
{
    uint8_t open;

    if (column < 0 || column >= XCSCR_COLUMNS || row < 0 || row >= XCSCR_ROWS) {
        return 0;
    }
    XCSCR_READ(open, xcscr_open[(uint32_t)row * XCSCR_COLUMNS + (uint32_t)column]);
    return open;
}

/* Writes the percept of a robot in the middle of a cell: the moves that the map has open, without those that the
 * robot sees blocked. `walls` has a bit for each of these, clockwise from north. Of the cells around, open is 00,
 * not open 01, and a goal 11 if the percept shows goals. */
static inline void xcscr_percept_from_walls(uint8_t walls, uint16_t column, uint16_t row, xcscr_word *percept)
{
    static const int8_t steps[8][2] = {{0, 1}, {1, 1}, {1, 0}, {1, -1}, {0, -1}, {-1, -1}, {-1, 0}, {-1, 1}};
    const uint8_t open = (uint8_t)(xcscr_open_moves(column, row) & ~walls);
    int at;

    xcscr_begin_percept(percept, column, row);
    for (at = 0; at < XCSCR_RING_BITS / 2; at++) {
        const int is_open = open >> at & 1;
        const int is_goal = XCSCR_SHOWS_GOALS && xcscr_is_goal(column + steps[at][0], row - steps[at][1]);
        if (is_open && is_goal) {
            xcscr_set(percept, 2 * at);
        }
        if (!is_open || is_goal) {
            xcscr_set(percept, 2 * at + 1);
        }
    }
}

/* Writes the percept at a pose of the map frame, in metres. Returns 0 if the pose is not finite or outside of the
 * grid, otherwise 1. */
static inline int xcscr_percept(double x_m, double y_m, xcscr_word *percept)
{
    uint16_t column = 0;
    uint16_t row = 0;
    const int is_inside = xcscr_cell_from_pose(x_m, y_m, &column, &row);

    xcscr_percept_from_walls(0, column, row, percept);
    return is_inside;
}

/* Returns a bit for each action that is open from a cell: by the map, and by the walls that the robot sees. */
static inline uint16_t xcscr_open_actions(uint8_t walls, uint16_t column, uint16_t row)
{
    const uint8_t moves = (uint8_t)(xcscr_open_moves(column, row) & ~walls);
    uint16_t open = 0;
    int action;

    for (action = 0; action < XCSCR_ACTIONS; action++) {
        if ((moves >> 8 / XCSCR_ACTIONS * action & 1) != 0) {
            open = (uint16_t)(open | 1u << action);
        }
    }
    return open;
}
