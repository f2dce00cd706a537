
/* Sixteen beams, clockwise from north: the number of free cells that each goes through, at most seven. The
 * beams between the eight directions go two cells along and one across. */
static inline void xcscr_set_ring(xcscr_word *percept, xcscr_is_free is_free, const void *seen)
{
    int beam;

    for (beam = 0; beam < 16; beam++) {
        /* Of the directions beside the beam the one that is no diagonal, and the diagonal. */
        const int main_way = (beam / 2 + (beam % 4 == 3)) % 8;
        const int diagonal = (beam / 2 + (beam % 4 == 1)) % 8;
        int along[2];
        int across[2];
        along[0] = xcscr_east_of(main_way);
        along[1] = xcscr_north_of(main_way);
        across[0] = xcscr_east_of(diagonal) - along[0];
        across[1] = xcscr_north_of(diagonal) - along[1];
        if (beam % 2 == 0) {
            across[0] = along[0];
            across[1] = along[1];
        }
        xcscr_set_number(percept, 3 * beam, 3, xcscr_free_cells(is_free, seen, along, across, 7));
    }
}
