/* Is the cell so many cells to the east and to the north of the robot free? */
typedef int (*xcscr_is_free)(const void *seen, int east, int north);

/* Is it free, and not hidden behind the corner of two walls, as seen from the cell before it? */
static inline int xcscr_is_seen(xcscr_is_free is_free, const void *seen, const int from[2], const int8_t step[2])
{
    const int hidden = step[0] != 0 && step[1] != 0 && !is_free(seen, from[0] + step[0], from[1])
                       && !is_free(seen, from[0], from[1] + step[1]);

    return !hidden && is_free(seen, from[0] + step[0], from[1] + step[1]);
}

/* Counts the cells that a ray goes through until it meets a wall; every third step, from the second on, is
 * `across`. */
static inline int xcscr_free_cells(xcscr_is_free is_free, const void *seen, const struct xcscr_ray *ray)
{
    int at[2] = {0, 0};
    int count;

    for (count = 0; count < ray->most; count++) {
        const int8_t *step = count % 3 == 1 ? ray->across : ray->along;
        if (!xcscr_is_seen(is_free, seen, at, step)) {
            break;
        }
        at[0] += step[0];
        at[1] += step[1];
    }
    return count;
}

/* Writes what the rays show, one after the other. */
static inline void xcscr_set_ring(xcscr_word *percept, xcscr_is_free is_free, const void *seen)
{
    int at;
    int first = 0;

    for (at = 0; at < XCSCR_RAYS; at++) {
        struct xcscr_ray ray;
        XCSCR_READ(ray, xcscr_rays[at]);
        xcscr_set_number(percept, first, ray.bits, ray.codes[xcscr_free_cells(is_free, seen, &ray)]);
        first += ray.bits;
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
