/* Sets a bit of a percept; bits that the policy does not look at are left out. */
static inline void xcscr_set(xcscr_word *percept, int bit)
{
    const int word = bit / XCSCR_WORD_BITS;

    if (word < XCSCR_WORDS) {
        percept[word] = (xcscr_word)(percept[word] | (1u << bit % XCSCR_WORD_BITS));
    }
}

/* Writes a number into so many bits of a percept, the highest first. */
static inline void xcscr_set_number(xcscr_word *percept, int first, int bits, int32_t number)
{
    int bit;

    for (bit = 0; bit < bits; bit++) {
        if ((number >> (bits - 1 - bit) & 1) != 0) {
            xcscr_set(percept, first + bit);
        }
    }
}

/* Clears a percept, and writes column and row behind the bits of the cells around, if it has them. */
static inline void xcscr_begin_percept(xcscr_word *percept, int32_t column, int32_t row)
{
    int word;

    for (word = 0; word < XCSCR_WORDS; word++) {
        percept[word] = 0;
    }
    xcscr_set_number(percept, XCSCR_RING_BITS, XCSCR_COLUMN_BITS, column);
    xcscr_set_number(percept, XCSCR_RING_BITS + XCSCR_COLUMN_BITS, XCSCR_ROW_BITS, row);
}
