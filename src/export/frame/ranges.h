
/* For each main direction, clockwise from north: is it free for one cell, for two, for three, and is the
 * diagonal cell free that follows clockwise? */
static inline void xcscr_set_ring(xcscr_word *percept, xcscr_is_free is_free, const void *seen)
{
    const int here[2] = {0, 0};
    int bit;

    for (bit = 0; bit < 16; bit += 4) {
        int step[2];
        int far;
        int free_cells;
        step[0] = xcscr_east_of(bit / 2);
        step[1] = xcscr_north_of(bit / 2);
        free_cells = xcscr_free_cells(is_free, seen, step, step, 3);
        for (far = 0; far < free_cells; far++) {
            xcscr_set(percept, bit + far);
        }
        step[0] = xcscr_east_of(bit / 2 + 1);
        step[1] = xcscr_north_of(bit / 2 + 1);
        if (xcscr_is_seen(is_free, seen, here, step)) {
            xcscr_set(percept, bit + 3);
        }
    }
}
