//! The parts of the tracker in C99. Which parts are used depends on whether moves slip and on
//! whether percepts have errors.

/// The types that are the same for all maps.
pub const TYPES: &str = r"
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

/* The state of an episode. */
struct xcscr_tracker {
    xcscr_weight belief[XCSCR_STATES]; /* the probability of each state, up to a factor */
    xcscr_weight next[XCSCR_STATES];   /* the next belief, while it is computed */
    uint32_t last;                     /* the last step */
    uint32_t before;                   /* the step before the last */
    uint16_t percept;                  /* the last percept */
    int8_t action;                     /* the action chosen for it, or XCSCR_NO_ACTION */
    uint8_t found;                     /* the number of rewards collected */
};
";

/// Integer beliefs.
pub const WHOLE_WEIGHT: &str = r"
/* The weight of a state; only the ratios matter. */
typedef uint16_t xcscr_weight;
";

/// Floating-point beliefs.
pub const DOUBLE_WEIGHT: &str = r"
/* The probability of a state. */
typedef double xcscr_weight;
";

/// Removes negligible states from integer beliefs.
pub const SETTLE_WHOLE: &str = r"
/* Removes unlikely states. Returns 1 if any state is left. */
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

/// Like [`SETTLE_WHOLE`], for floating-point beliefs, which are normalised to a sum of 1.
pub const SETTLE_DOUBLE: &str = r"
/* Removes unlikely states and normalises the others to a sum of 1. Returns 1 if any state is left. */
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

/// The parts that all trackers share: reading states, rewards, the likeliest state and the context.
pub const COMMON: &str = r"
static inline struct xcscr_state xcscr_state(uint16_t at)
{
    struct xcscr_state state;
    XCSCR_READ(state, xcscr_states[at]);
    return state;
}

/* Returns the number of rewards collected. */
static inline uint8_t xcscr_count(uint8_t collected)
{
    return (uint8_t)((collected & 1) + (collected >> 1 & 1) + (collected >> 2 & 1) + (collected >> 3 & 1));
}

/* Returns in how many of the eight surrounding cells two percepts differ. The value 1 is not a cell
 * state. It counts as 0 (free), because most cells are free. */
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

/* Returns the likeliest state, the first of several; XCSCR_GOAL if the belief is empty. */
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

/* Returns the input of the rules. */
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

/// The successors of a state. The placeholders are filled with the evidence after the action and
/// the moves that may be executed.
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

/* Computes the next belief after the last action. Returns 1 if any state is left. */
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

/// The chosen action is executed.
pub const EXACT_MOVES: &str =
    "            xcscr_move(tracker, from, tracker->action, weight{FELT});";

/// The chosen action is executed, or another one, each with the same probability.
pub const SLIPPING_MOVES: &str = "            int8_t executed;
            xcscr_move(tracker, from, tracker->action, weight * (1.0 - XCSCR_SLIP){FELT});
            for (executed = 0; executed < XCSCR_ACTIONS; executed++) {
                if (executed != tracker->action) {
                    xcscr_move(tracker, from, executed, weight * (XCSCR_SLIP / (XCSCR_ACTIONS - 1)){FELT});
                }
            }";

/// The functions that the robot's program calls.
pub const PERCEIVE: &str = r"
/* Resets the tracker at the beginning of an episode. */
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

/* Returns the action for a percept. bumped and rewarded describe the result of the last action. */
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
