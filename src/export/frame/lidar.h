
/* Is the cell so many cells to the east and to the north of the robot free? */
typedef int (*xcscr_is_free)(const void *seen, int east, int north);

/* Is it free, and not hidden behind the corner of two walls, as seen from the cell before it? */
static inline int xcscr_is_seen(xcscr_is_free is_free, const void *seen, const int from[2], const int step[2])
{
    const int hidden = step[0] != 0 && step[1] != 0 && !is_free(seen, from[0] + step[0], from[1])
                       && !is_free(seen, from[0], from[1] + step[1]);

    return !hidden && is_free(seen, from[0] + step[0], from[1] + step[1]);
}

static inline void xcscr_set_ring(xcscr_word *percept, xcscr_is_free is_free, const void *seen);

static inline int xcscr_map_is_free(const void *seen, int east, int north)
{
    return xcscr_state_at((const struct xcscr_map *)seen, east, north) != XCSCR_CELL_WALL;
}

static inline void xcscr_set_ring_from_map(xcscr_word *percept, const struct xcscr_map *map)
{
    xcscr_set_ring(percept, xcscr_map_is_free, map);
}
