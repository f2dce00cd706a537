/* The cells around the robot, clockwise from north: free 00, wall 01, goal 11. */
static inline void xcscr_set_ring_from_map(xcscr_word *percept, const struct xcscr_map *map)
{
    int bit;

    for (bit = 0; bit < XCSCR_RING_BITS; bit += 2) {
        const uint8_t state = xcscr_state_at(map, xcscr_east_of(bit / 2), xcscr_north_of(bit / 2));
        if (state == XCSCR_CELL_GOAL) {
            xcscr_set(percept, bit);
        }
        if (state != XCSCR_CELL_FREE) {
            xcscr_set(percept, bit + 1);
        }
    }
}
