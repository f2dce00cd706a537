
/* Counts the cells that a beam goes through until it meets a wall; every third step, from the second on,
 * is `across`. */
static inline int xcscr_free_cells(xcscr_is_free is_free, const void *seen, const int along[2],
                                   const int across[2], int most)
{
    int at[2] = {0, 0};
    int count;

    for (count = 0; count < most; count++) {
        const int *step = count % 3 == 1 ? across : along;
        if (!xcscr_is_seen(is_free, seen, at, step)) {
            break;
        }
        at[0] += step[0];
        at[1] += step[1];
    }
    return count;
}
