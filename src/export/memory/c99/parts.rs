//! The tracker in C99, in parts: which are taken depends on whether moves slip and percepts are misread.

/// The types that do not depend on anything.
pub const TYPES: &str = r"
/* A state: a place on a map, and what was found before. */
struct xcscr_state {
    uint16_t next[XCSCR_ACTIONS]; /* the state that each action leads to, or XCSCR_GOAL */
    uint16_t percept;             /* what is perceived there */
    int8_t x;                     /* cells to the east of the goal */
    int8_t y;                     /* cells to the north of it */
    uint8_t map;                /* the number of the map: each is drawn around one goal */
    uint8_t collected;                /* as bits: which rewards of the map were found */
};

/* What rules look at. A step is 1 + 2 * action + 16 * percept, or 0 if there was none. */
struct xcscr_context {
    uint32_t last;    /* the last step */
    uint32_t before;  /* the step before it */
    uint16_t percept; /* what is perceived; where observations have errors, what should be */
    int8_t x;         /* the likeliest state */
    int8_t y;
    uint8_t map;
    uint8_t collected;
};

/* What is remembered of an episode. */
struct xcscr_tracker {
    xcscr_weight belief[XCSCR_STATES]; /* how likely each state is */
    xcscr_weight next[XCSCR_STATES];   /* the same while it is being computed */
    uint32_t last;                     /* the last step */
    uint32_t before;                   /* the step before it */
    uint16_t percept;                  /* what is perceived */
    int8_t action;                     /* what is done on it, or XCSCR_NO_ACTION */
    uint8_t found;                     /* how many rewards were found */
};
";

/// Beliefs in whole numbers.
pub const WHOLE_WEIGHT: &str = r"
/* How likely a state is; only the ratios count. */
typedef uint16_t xcscr_weight;
";

/// Beliefs in fractions.
pub const DOUBLE_WEIGHT: &str = r"
/* The probability of a state. */
typedef double xcscr_weight;
";

/// Forgets what is negligible, in whole numbers.
pub const SETTLE_WHOLE: &str = r"
/* Forgets states that are unlikely; is any left? */
static inline int xcscr_settle(xcscr_weight *belief)
{
    uint32_t sum = 0;
    uint16_t at;
    int any = 0;

    for (at = 0; at < XCSCR_STATES; at++) {
        sum += belief[at];
    }
    for (at = 0; at < XCSCR_STATES; at++) {
        if (belief[at] * (uint32_t)10000 > sum) {
            any = 1;
        } else {
            belief[at] = 0;
        }
    }
    return any;
}
";

/// The same in fractions, which then add up to 1.
pub const SETTLE_DOUBLE: &str = r"
/* Forgets states that are unlikely, and makes the others add up to 1; is any left? */
static inline int xcscr_settle(xcscr_weight *belief)
{
    double sum = 0.0;
    double kept = 0.0;
    uint16_t at;

    for (at = 0; at < XCSCR_STATES; at++) {
        sum += belief[at];
    }
    for (at = 0; at < XCSCR_STATES; at++) {
        if (belief[at] > {NEGLIGIBLE} * sum) {
            kept += belief[at];
        } else {
            belief[at] = 0.0;
        }
    }
    for (at = 0; at < XCSCR_STATES && kept > 0.0; at++) {
        belief[at] /= kept;
    }
    return kept > 0.0;
}
";

/// What all trackers share: reading states, rewards, the likeliest state, the context, votes.
pub const COMMON: &str = r"
static inline struct xcscr_state xcscr_state(uint16_t at)
{
    struct xcscr_state state;
    XCSCR_READ(state, xcscr_states[at]);
    return state;
}

/* How many rewards were found. */
static inline uint8_t xcscr_count(uint8_t collected)
{
    return (uint8_t)((collected & 1) + (collected >> 1 & 1) + (collected >> 2 & 1) + (collected >> 3 & 1));
}

/* In how many of the eight cells around the robot two percepts differ. A goal that is not barred, 1, is
 * no letter: most cells are free, 0. */
static inline int xcscr_differences(uint16_t a, uint16_t b)
{
    int differences = 0;
    int cell;

    for (cell = 0; cell < 16; cell += 2) {
        const int in_a = a >> cell & 3;
        const int in_b = b >> cell & 3;
        differences += (in_a == 1 ? 0 : in_a) != (in_b == 1 ? 0 : in_b);
    }
    return differences;
}

/* The likeliest state, the first of several; XCSCR_GOAL if nothing is believed. */
static inline uint16_t xcscr_likeliest(const struct xcscr_tracker *tracker)
{
    xcscr_weight most = 0;
    uint16_t likeliest = XCSCR_GOAL;
    uint16_t at;

    for (at = 0; at < XCSCR_STATES; at++) {
        if (tracker->belief[at] > most) {
            most = tracker->belief[at];
            likeliest = at;
        }
    }
    return likeliest;
}

/* What rules look at. */
static inline struct xcscr_context xcscr_context(const struct xcscr_tracker *tracker)
{
    struct xcscr_context context = {0, 0, 0, 0, 0, 0, 0};
    const uint16_t likeliest = xcscr_likeliest(tracker);

    context.last = tracker->last;
    context.before = tracker->before;
    context.percept = tracker->percept;
    if (likeliest != XCSCR_GOAL) {
        const struct xcscr_state state = xcscr_state(likeliest);
        context.x = state.x;
        context.y = state.y;
        context.map = state.map;
        context.collected = state.collected;
    }
    return context;
}
";

/// Where an action leads. Filled in are what is felt after it, and the moves that may be executed.
pub const FOLLOW: &str = r"
/* {FELT_WORDS} */
static inline void xcscr_move(struct xcscr_tracker *tracker, uint16_t from, int8_t executed,
                              xcscr_weight weight{FELT_TYPES})
{
    const uint16_t to = xcscr_state(from).next[executed];
    if (to != XCSCR_GOAL{FELT_FITS}) {
        tracker->next[to] = (xcscr_weight)(tracker->next[to] + weight);
    }
}

/* The same for the last action and all that is believed; can anything come of it? */
static inline int xcscr_follow(struct xcscr_tracker *tracker{FELT_TYPES})
{
    uint16_t from;

    for (from = 0; from < XCSCR_STATES; from++) {
        tracker->next[from] = 0;
    }
    for (from = 0; from < XCSCR_STATES; from++) {
        const xcscr_weight weight = tracker->belief[from];
        if (weight > 0) {
{MOVES}
        }
    }
    return xcscr_settle(tracker->next);
}
";

/// The action that was chosen is executed.
pub const EXACT_MOVES: &str =
    "            xcscr_move(tracker, from, tracker->action, weight{FELT});";

/// It is, or another one, each with the same chance.
pub const SLIPPING_MOVES: &str = "            int8_t executed;
            xcscr_move(tracker, from, tracker->action, weight * (1.0 - XCSCR_SLIP){FELT});
            for (executed = 0; executed < XCSCR_ACTIONS; executed++) {
                if (executed != tracker->action) {
                    xcscr_move(tracker, from, executed, weight * (XCSCR_SLIP / (XCSCR_ACTIONS - 1)){FELT});
                }
            }";

/// What the robot's program calls.
pub const PERCEIVE: &str = r"
/* An episode begins. */
static inline void xcscr_reset(struct xcscr_tracker *tracker)
{
    uint16_t at;

    for (at = 0; at < XCSCR_STATES; at++) {
        tracker->belief[at] = {BEGIN};
    }
    tracker->last = 0;
    tracker->before = 0;
    tracker->percept = 0;
    tracker->action = XCSCR_NO_ACTION;
    tracker->found = 0;
}

/* The action for what is perceived now, and what came of the action before it. */
static inline int8_t xcscr_perceive(struct xcscr_tracker *tracker, uint16_t percept, int bumped,
                                    int rewarded)
{
    struct xcscr_context context;

    if (tracker->action != XCSCR_NO_ACTION) {
        tracker->before = tracker->last;
        tracker->last = 1u | (uint32_t)tracker->action << 1 | (uint32_t)tracker->percept << 4;
    }
    xcscr_locate(tracker, percept, bumped != 0, rewarded);
    context = xcscr_context(tracker);
    tracker->action = xcscr_decide(&context);
    return tracker->action;
}
";
