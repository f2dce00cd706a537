/* The percepts that a rule matches: for each byte a mask of the demanded bits, and their values; then the
 * least and the greatest column and row. */
struct xcscr_condition {
    uint8_t bytes[XCSCR_PERCEPT_BYTES][2];
    uint16_t column[2];
    uint16_t row[2];
};

/* The number that some bits of a percept encode, the highest first. */
static inline uint16_t xcscr_number(const xcscr_input *percept, uint16_t first, uint16_t bits)
{
    uint16_t bit, number = 0;

    for (bit = first; bit < first + bits; bit++) {
        number = (uint16_t)(number << 1 | (percept[bit / 8] >> bit % 8 & 1));
    }
    return number;
}

static inline int xcscr_matches(const struct xcscr_condition *condition, const xcscr_input *percept)
{
    uint16_t column = xcscr_number(percept, XCSCR_RING_BITS, XCSCR_COLUMN_BITS);
    uint16_t row = xcscr_number(percept, XCSCR_RING_BITS + XCSCR_COLUMN_BITS, XCSCR_ROW_BITS);
    uint8_t byte;

    for (byte = 0; byte < XCSCR_PERCEPT_BYTES; byte++) {
        if ((percept[byte] & condition->bytes[byte][0]) != condition->bytes[byte][1]) {
            return 0;
        }
    }
    return column >= condition->column[0] && column <= condition->column[1]
           && row >= condition->row[0] && row <= condition->row[1];
}
