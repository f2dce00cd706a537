static inline void xcscr_set_ring_from_map(xcscr_word *percept, const struct xcscr_map *map);

/* Writes the percept of a robot in the middle of a cell. */
static inline void xcscr_percept_from_map(uint16_t column, uint16_t row, xcscr_look_up look_up, void *user,
                                          xcscr_word *percept)
{
    struct xcscr_map map;

    map.look_up = look_up;
    map.user = user;
    map.column = column;
    map.row = row;
    xcscr_begin_percept(percept, column, row);
    xcscr_set_ring_from_map(percept, &map);
}
