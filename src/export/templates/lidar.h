/* Writes the cells around the robot, clockwise from north: free 00, wall 01. Bit i of `walls` is set if cell i is a
 * wall. A cell behind the corner of two walls is hidden, and counts as a wall. */
static inline void xcscr_set_ring(xcscr_word *percept, uint8_t walls)
{
    int at;

    for (at = 0; at < XCSCR_RING_BITS / 2; at++) {
        const int hidden = at % 2 != 0 && (walls >> (at - 1) & 1) != 0 && (walls >> (at + 1) % 8 & 1) != 0;
        if (hidden || (walls >> at & 1) != 0) {
            xcscr_set(percept, 2 * at + 1);
        }
    }
}

/* Writes the percept of a robot in the middle of a cell that sees these walls: a bit for each of the eight cells
 * around, clockwise from north. */
static inline void xcscr_percept_from_walls(uint8_t walls, uint16_t column, uint16_t row, xcscr_word *percept)
{
    xcscr_begin_percept(percept, column, row);
    xcscr_set_ring(percept, walls);
}

static inline void xcscr_set_ring_from_map(xcscr_word *percept, const struct xcscr_map *map)
{
    uint8_t walls = 0;
    int at;

    for (at = 0; at < 8; at++) {
        if (xcscr_state_at(map, xcscr_east_of(at), xcscr_north_of(at)) == XCSCR_CELL_WALL) {
            walls = (uint8_t)(walls | 1u << at);
        }
    }
    xcscr_set_ring(percept, walls);
}
