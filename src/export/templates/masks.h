/* The percepts that a rule matches: for each byte a mask of the demanded bits, and their values. */
struct xcscr_condition {
    uint8_t bytes[XCSCR_PERCEPT_BYTES][2];
};

static inline int xcscr_matches(const struct xcscr_condition *condition, const xcscr_input *percept)
{
    uint8_t byte;

    for (byte = 0; byte < XCSCR_PERCEPT_BYTES; byte++) {
        if ((percept[byte] & condition->bytes[byte][0]) != condition->bytes[byte][1]) {
            return 0;
        }
    }
    return 1;
}
