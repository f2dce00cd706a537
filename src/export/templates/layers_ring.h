/* Writes the cells around the robot, clockwise from north: open 00, not open 01, and goal 11 if the percept shows
 * goals. */
static inline void xcscr_set_ring(xcscr_word *percept, const struct xcscr_place *place)
{
    static const int8_t steps[8][2] = {{0, 1}, {1, 1}, {1, 0}, {1, -1}, {0, -1}, {-1, -1}, {-1, 0}, {-1, 1}};
    int bit;

    for (bit = 0; bit < XCSCR_RING_BITS; bit += 2) {
        const int8_t *step = steps[bit / 2];
        const int is_open = xcscr_passes(place, step);
        const int is_goal = XCSCR_SHOWS_GOALS && xcscr_is_goal(place->column + step[0], place->row - step[1]);
        if (is_open && is_goal) {
            xcscr_set(percept, bit);
        }
        if (!is_open || is_goal) {
            xcscr_set(percept, bit + 1);
        }
    }
}
