/* Moves and percepts without errors allow whole numbers as beliefs, of which only the ratios matter. */
#if defined(XCSCR_SLIPS) || defined(XCSCR_MISPERCEIVES)
typedef double xcscr_weight;
typedef double xcscr_sum;
#define XCSCR_IS_LIKELY(weight, sum) ((weight) > XCSCR_NEGLIGIBLE * (sum))
#else
typedef uint16_t xcscr_weight;
typedef uint32_t xcscr_sum;
#define XCSCR_IS_LIKELY(weight, sum) ((weight) * (uint32_t)XCSCR_NEGLIGIBLE_ONE_IN > (sum))
#endif

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

/* Removes unlikely states; probabilities then sum up to 1. Returns 1 if any state is left. */
static inline int xcscr_settle(xcscr_weight *belief)
{
    xcscr_sum sum = 0;
    xcscr_sum kept = 0;
    uint16_t at;

    for (at = 0; at < XCSCR_STATES; at++) {
        sum += belief[at];
    }
    for (at = 0; at < XCSCR_STATES; at++) {
        if (XCSCR_IS_LIKELY(belief[at], sum)) {
            kept += belief[at];
        } else {
            belief[at] = 0;
        }
    }
#if defined(XCSCR_SLIPS) || defined(XCSCR_MISPERCEIVES)
    for (at = 0; at < XCSCR_STATES && kept > 0; at++) {
        belief[at] /= kept;
    }
#endif
    return kept > 0;
}

/* What is known after an action: the percept, the number of rewards collected, and whether the robot bumped
 * into a wall. */
struct xcscr_evidence {
    uint16_t percept;
    uint8_t found;
    int bumped;
};

/* Returns 1 if a state has this percept and this number of collected rewards. */
static inline int xcscr_looks(uint16_t at, const struct xcscr_evidence *seen)
{
    const struct xcscr_state state = xcscr_state(at);
    return state.percept == seen->percept && xcscr_count(state.collected) == seen->found;
}

/* Returns 1 if a transition fits what is known. A percept without errors also shows a collision. */
static inline int xcscr_fits(uint16_t from, uint16_t to, const struct xcscr_evidence *seen)
{
#if defined(XCSCR_MISPERCEIVES)
    return XCSCR_IGNORES_COLLISIONS || (to == from) == seen->bumped;
#else
    (void)from;
    return xcscr_looks(to, seen);
#endif
}

/* Adds the successor of an action to the next belief if it fits. */
static inline void xcscr_move(struct xcscr_tracker *tracker, uint16_t from, int8_t executed,
                              xcscr_weight weight, const struct xcscr_evidence *seen)
{
    const uint16_t to = xcscr_state(from).next[executed];
    if (to != XCSCR_GOAL && xcscr_fits(from, to, seen)) {
        tracker->next[to] = (xcscr_weight)(tracker->next[to] + weight);
    }
}

/* Computes the next belief after the last action. Returns 1 if any state is left. */
static inline int xcscr_follow(struct xcscr_tracker *tracker, const struct xcscr_evidence *seen)
{
    uint16_t from;

    for (from = 0; from < XCSCR_STATES; from++) {
        tracker->next[from] = 0;
    }
    for (from = 0; from < XCSCR_STATES; from++) {
        const xcscr_weight weight = tracker->belief[from];
        if (weight > 0) {
#if defined(XCSCR_SLIPS)
            int8_t executed;
            xcscr_move(tracker, from, tracker->action, weight * (1.0 - XCSCR_SLIP), seen);
            for (executed = 0; executed < XCSCR_ACTIONS; executed++) {
                if (executed != tracker->action) {
                    xcscr_move(tracker, from, executed, weight * (XCSCR_SLIP / (XCSCR_ACTIONS - 1)), seen);
                }
            }
#else
            xcscr_move(tracker, from, tracker->action, weight, seen);
#endif
        }
    }
    return xcscr_settle(tracker->next);
}

#if defined(XCSCR_MISPERCEIVES)
/* Computes the belief before the percept. Returns 1 if any state is left. */
static inline int xcscr_expect(struct xcscr_tracker *tracker, const struct xcscr_evidence *seen)
{
    int any = 0;
    uint16_t at;

    if (tracker->action != XCSCR_NO_ACTION) {
        return xcscr_follow(tracker, seen);
    }
    for (at = 0; at < XCSCR_STATES; at++) {
        tracker->next[at] = tracker->belief[at];
        any = any || tracker->belief[at] > 0.0;
    }
    return any;
}

/* Returns the probability of this number of observation errors, up to a factor. */
static inline double xcscr_observation_error(int cells)
{
    double likely = 1.0;

    for (; cells > 0; cells--) {
        likely *= XCSCR_OBSERVATION_ERROR;
    }
    return likely;
}

/* Updates the belief. Each state is weighted by its prediction and by the number of observation errors
 * that it implies. With a small probability the robot is in any state. */
static inline void xcscr_locate(struct xcscr_tracker *tracker, struct xcscr_evidence seen, int rewarded)
{
    double mislocalised = tracker->action == XCSCR_NO_ACTION ? XCSCR_BEGUN_ELSEWHERE : XCSCR_MISLOCALISED;
    uint16_t at;

    if (!xcscr_expect(tracker, &seen)) {
        mislocalised = 1.0;
    }
    if (tracker->action != XCSCR_NO_ACTION && rewarded) {
        tracker->found++;
        if (tracker->found > XCSCR_REWARDS) {
            tracker->found = XCSCR_REWARDS;
        }
    }
    for (at = 0; at < XCSCR_STATES; at++) {
        const struct xcscr_state state = xcscr_state(at);
        const double weight = tracker->next[at] * (1.0 - mislocalised) + mislocalised / XCSCR_STATES;
        const int wrong = xcscr_differences(state.percept, seen.percept)
                          + (xcscr_count(state.collected) != tracker->found);
        tracker->belief[at] = weight * xcscr_observation_error(wrong);
    }
    (void)xcscr_settle(tracker->belief);
    at = xcscr_likeliest(tracker);
    tracker->percept = at == XCSCR_GOAL ? seen.percept : xcscr_state(at).percept;
}
#else
/* Takes over the next belief if the evidence leaves any. Returns 1 if it does. */
static inline int xcscr_believe(struct xcscr_tracker *tracker, const struct xcscr_evidence *seen)
{
    uint16_t at;

    if (!xcscr_follow(tracker, seen)) {
        return 0;
    }
    tracker->found = seen->found;
    for (at = 0; at < XCSCR_STATES; at++) {
        tracker->belief[at] = tracker->next[at];
    }
    return 1;
}

/* Returns 1 if the belief is not empty and all its states have this percept. */
static inline int xcscr_is_right(const struct xcscr_tracker *tracker, const struct xcscr_evidence *seen)
{
    int any = 0;
    uint16_t at;

    for (at = 0; at < XCSCR_STATES; at++) {
        if (tracker->belief[at] > 0) {
            any = 1;
            if (!xcscr_looks(at, seen)) {
                return 0;
            }
        }
    }
    return any;
}

/* Spreads the belief over all states whose percept differs least. */
static inline void xcscr_look_around(struct xcscr_tracker *tracker, uint16_t percept)
{
    int least = 9;
    uint16_t at;

    for (at = 0; at < XCSCR_STATES; at++) {
        const struct xcscr_state state = xcscr_state(at);
        const int differences = xcscr_differences(state.percept, percept);
        if (xcscr_count(state.collected) == tracker->found && differences < least) {
            least = differences;
        }
    }
    for (at = 0; at < XCSCR_STATES; at++) {
        const struct xcscr_state state = xcscr_state(at);
        tracker->belief[at] = xcscr_count(state.collected) == tracker->found
                              && xcscr_differences(state.percept, percept) == least;
    }
    (void)xcscr_settle(tracker->belief);
}

/* Updates the belief with a percept without errors. */
static inline void xcscr_locate(struct xcscr_tracker *tracker, struct xcscr_evidence seen, int rewarded)
{
    /* A reward that was not predicted, or did not come, still gives evidence about the state. */
    struct xcscr_evidence otherwise = seen;

    tracker->percept = seen.percept;
    if (tracker->action == XCSCR_NO_ACTION) {
        if (!xcscr_is_right(tracker, &seen)) {
            xcscr_look_around(tracker, seen.percept);
        }
        return;
    }
    seen.found = (uint8_t)(tracker->found + (rewarded != 0));
    otherwise.found = (uint8_t)(tracker->found + (rewarded == 0));
    if (!xcscr_believe(tracker, &seen) && !xcscr_believe(tracker, &otherwise)) {
        tracker->found = seen.found > XCSCR_REWARDS ? XCSCR_REWARDS : seen.found;
        xcscr_look_around(tracker, seen.percept);
    }
}
#endif

/* Resets the tracker at the beginning of an episode. */
static inline void xcscr_reset(struct xcscr_tracker *tracker)
{
    uint16_t at;

    for (at = 0; at < XCSCR_STATES; at++) {
        tracker->belief[at] = at == XCSCR_BEGIN;
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
    struct xcscr_evidence seen = {0, 0, 0};
    struct xcscr_context context;

    seen.percept = percept;
    seen.found = tracker->found;
    seen.bumped = bumped != 0;
    if (tracker->action != XCSCR_NO_ACTION) {
        tracker->before = tracker->last;
        tracker->last = 1u | (uint32_t)tracker->action << 1 | (uint32_t)tracker->percept << 4;
    }
    xcscr_locate(tracker, seen, rewarded);
    context = xcscr_context(tracker);
    tracker->action = xcscr_decide(&context);
    return tracker->action;
}
