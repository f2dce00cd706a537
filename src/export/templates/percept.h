/* A percept is an array of XCSCR_PERCEPT_BYTES of these. */
typedef uint8_t xcscr_word;
typedef xcscr_word xcscr_input;
#define XCSCR_WORD_BITS 8
#define XCSCR_WORDS XCSCR_PERCEPT_BYTES
