
/* The eight cells around, clockwise from north: free 00, wall or hidden 01. */
static inline void xcscr_set_ring(xcscr_word *percept, xcscr_is_free is_free, const void *seen)
{
    const int here[2] = {0, 0};
    int direction;

    for (direction = 0; direction < 8; direction++) {
        int step[2];
        step[0] = xcscr_east_of(direction);
        step[1] = xcscr_north_of(direction);
        if (!xcscr_is_seen(is_free, seen, here, step)) {
            xcscr_set(percept, 2 * direction + 1);
        }
    }
}
