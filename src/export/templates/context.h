/* A percept is one of these. */
typedef uint16_t xcscr_word;
#define XCSCR_WORD_BITS 16
#define XCSCR_WORDS 1

/* A state: a cell of a map, and the rewards collected so far. */
struct xcscr_state {
    uint16_t next[XCSCR_ACTIONS]; /* the state that each action leads to, or XCSCR_GOAL */
    uint16_t percept;             /* the percept in this state */
    int8_t x;                     /* cells to the east of the goal */
    int8_t y;                     /* cells to the north of the goal */
    uint8_t map;                  /* the number of the map: each is drawn around one goal */
    uint8_t collected;            /* a bit mask of the rewards of the map that were collected */
};

/* The input of the rules. A step is 1 + 2 * action + 16 * percept, or 0 if there was none. */
struct xcscr_context {
    uint32_t last;    /* the last step */
    uint32_t before;  /* the step before the last */
    uint16_t percept; /* the percept; with observation errors, the percept of the likeliest state */
    int8_t x;         /* the likeliest state */
    int8_t y;
    uint8_t map;
    uint8_t collected;
};
typedef struct xcscr_context xcscr_input;

/* The contexts that a rule matches: the least and the greatest coordinates; for all other parts a mask of
 * the demanded bits, and their values. */
struct xcscr_condition {
    uint16_t percept[2];
    int8_t x[2];
    int8_t y[2];
    uint8_t map[2];
    uint8_t collected[2];
    uint32_t last[2];
    uint32_t before[2];
};

static inline int xcscr_matches(const struct xcscr_condition *condition, const xcscr_input *context)
{
    return (context->percept & condition->percept[0]) == condition->percept[1]
           && context->x >= condition->x[0] && context->x <= condition->x[1]
           && context->y >= condition->y[0] && context->y <= condition->y[1]
           && (context->map & condition->map[0]) == condition->map[1]
           && (context->collected & condition->collected[0]) == condition->collected[1]
           && (context->last & condition->last[0]) == condition->last[1]
           && (context->before & condition->before[0]) == condition->before[1];
}
