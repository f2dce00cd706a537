/* Writes the cells around the robot, clockwise from north: open 00, not open 01, goal 11. */
static inline void xcscr_set_ring(xcscr_word *percept, const struct xcscr_place *place)
{
    static const int8_t steps[8][2] = {{0, 1}, {1, 1}, {1, 0}, {1, -1}, {0, -1}, {-1, -1}, {-1, 0}, {-1, 1}};
    const int here[2] = {0, 0};
    int bit;

    for (bit = 0; bit < XCSCR_RING_BITS; bit += 2) {
        const int8_t *step = steps[bit / 2];
        const int is_open = xcscr_passes(place, here, step);
        if (is_open && xcscr_is_goal(place->column + step[0], place->row - step[1])) {
            xcscr_set(percept, bit);
        }
        if (!is_open || xcscr_is_goal(place->column + step[0], place->row - step[1])) {
            xcscr_set(percept, bit + 1);
        }
    }
}
