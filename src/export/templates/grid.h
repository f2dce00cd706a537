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
