/* Counts the cells that a ray goes through until a move is not open; every third step, from the second on, is
 * `across`. */
static inline int xcscr_free_cells(const struct xcscr_place *place, const struct xcscr_ray *ray)
{
    int at[2] = {0, 0};
    int count;

    for (count = 0; count < ray->most; count++) {
        const int8_t *step = count % 3 == 1 ? ray->across : ray->along;
        if (!xcscr_passes(place, at, step)) {
            break;
        }
        at[0] += step[0];
        at[1] += step[1];
    }
    return count;
}

/* Writes what the rays show, one after the other. */
static inline void xcscr_set_ring(xcscr_word *percept, const struct xcscr_place *place)
{
    int at;
    int first = 0;

    for (at = 0; at < XCSCR_RAYS; at++) {
        struct xcscr_ray ray;
        XCSCR_READ(ray, xcscr_rays[at]);
        xcscr_set_number(percept, first, ray.bits, ray.codes[xcscr_free_cells(place, &ray)]);
        first += ray.bits;
    }
}
