/* Writes the percept at a pose of the map frame, in metres. `scan` may be a null pointer: then the percept is
 * that of the map. Returns 0 if the pose is not finite or outside of the grid, otherwise 1. */
static inline int xcscr_percept(double x_m, double y_m, const struct xcscr_scan *scan, xcscr_word *percept)
{
    struct xcscr_place place;
    uint16_t column = 0;
    uint16_t row = 0;
    const int is_inside = xcscr_cell_from_pose(x_m, y_m, &column, &row);

    place.column = column;
    place.row = row;
    place.scan = scan && scan->column == column && scan->row == row ? scan : 0;
    xcscr_begin_percept(percept, column, row);
    xcscr_set_ring(percept, &place);
    return is_inside;
}

/* Writes the percept of a robot that took a scan in its cell. Returns 0 if the scan began outside of the grid,
 * otherwise 1. */
static inline int xcscr_scan_percept(const struct xcscr_scan *scan, xcscr_word *percept)
{
    struct xcscr_place place;

    place.column = scan->column;
    place.row = scan->row;
    place.scan = scan;
    xcscr_begin_percept(percept, place.column, place.row);
    xcscr_set_ring(percept, &place);
    return scan->is_inside;
}

/* Returns a bit for each action that the scan shows to be open, from the cell in which the scan began. */
static inline uint16_t xcscr_open_actions(const struct xcscr_scan *scan)
{
    static const int8_t steps[8][2] = {{0, 1}, {1, 1}, {1, 0}, {1, -1}, {0, -1}, {-1, -1}, {-1, 0}, {-1, 1}};
    struct xcscr_place place;
    uint16_t open = 0;
    int action;

    place.column = scan->column;
    place.row = scan->row;
    place.scan = scan;
    for (action = 0; action < XCSCR_ACTIONS; action++) {
        if (xcscr_passes(&place, steps[8 / XCSCR_ACTIONS * action])) {
            open = (uint16_t)(open | 1u << action);
        }
    }
    return open;
}
