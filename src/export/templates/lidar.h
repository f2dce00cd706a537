/* Is the cell so many cells to the east and to the north of the robot free? */
typedef int (*xcscr_is_free)(const void *seen, int east, int north);

/* Writes the cells around the robot, clockwise from north: free 00, wall 01. A cell behind the corner of two walls is
 * hidden, and counts as a wall. */
static inline void xcscr_set_ring(xcscr_word *percept, xcscr_is_free is_free, const void *seen)
{
    int bit;

    for (bit = 0; bit < XCSCR_RING_BITS; bit += 2) {
        const int east = xcscr_east_of(bit / 2);
        const int north = xcscr_north_of(bit / 2);
        const int hidden = east != 0 && north != 0 && !is_free(seen, east, 0) && !is_free(seen, 0, north);
        if (hidden || !is_free(seen, east, north)) {
            xcscr_set(percept, bit + 1);
        }
    }
}

static inline int xcscr_map_is_free(const void *seen, int east, int north)
{
    return xcscr_state_at((const struct xcscr_map *)seen, east, north) != XCSCR_CELL_WALL;
}

static inline void xcscr_set_ring_from_map(xcscr_word *percept, const struct xcscr_map *map)
{
    xcscr_set_ring(percept, xcscr_map_is_free, map);
}
