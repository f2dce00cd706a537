//! Localisation in C99: one version for exact percepts, one for percepts with errors.

/// Tests whether a state fits a percept.
pub const LOOKS: &str = r"
/* Returns 1 if a state has this percept and this number of collected rewards. */
static inline int xcscr_looks(uint16_t at, uint16_t percept, uint8_t found)
{
    const struct xcscr_state state = xcscr_state(at);
    return state.percept == percept && xcscr_count(state.collected) == found;
}
";

/// Localisation with exact percepts.
pub const LOCATE_EXACT: &str = r"
static inline void xcscr_believe_next(struct xcscr_tracker *tracker, uint8_t found)
{
    uint16_t at;

    tracker->found = found;
    for (at = 0; at < XCSCR_STATES; at++) {
        tracker->belief[at] = tracker->next[at];
    }
}

/* Returns 1 if the belief is not empty and all its states have this percept. */
static inline int xcscr_is_right(const struct xcscr_tracker *tracker, uint16_t percept)
{
    int any = 0;
    uint16_t at;

    for (at = 0; at < XCSCR_STATES; at++) {
        if (tracker->belief[at] > 0) {
            any = 1;
            if (!xcscr_looks(at, percept, tracker->found)) {
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

/* Updates the belief. A collision shows in the percept. */
static inline void xcscr_locate(struct xcscr_tracker *tracker, uint16_t percept, int bumped,
                                int rewarded)
{
    const uint8_t found = (uint8_t)(tracker->found + (rewarded != 0));
    /* A reward that was not predicted, or did not come, still gives evidence about the state. */
    const uint8_t otherwise = (uint8_t)(tracker->found + (rewarded == 0));

    (void)bumped;
    if (tracker->action == XCSCR_NO_ACTION) {
        if (!xcscr_is_right(tracker, percept)) {
            xcscr_look_around(tracker, percept);
        }
    } else if (xcscr_follow(tracker, percept, found)) {
        xcscr_believe_next(tracker, found);
    } else if (xcscr_follow(tracker, percept, otherwise)) {
        xcscr_believe_next(tracker, otherwise);
    } else {
        tracker->found = found > XCSCR_REWARDS ? XCSCR_REWARDS : found;
        xcscr_look_around(tracker, percept);
    }
    tracker->percept = percept;
}
";

/// Localisation with observation errors.
pub const LOCATE_NOISY: &str = r"
/* Computes the belief before the percept. Returns 1 if any state is left. */
static inline int xcscr_expect(struct xcscr_tracker *tracker{FELT_TYPES})
{
    int any = 0;
    uint16_t at;

    if (tracker->action != XCSCR_NO_ACTION) {
        return xcscr_follow(tracker{FELT});
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
static inline void xcscr_locate(struct xcscr_tracker *tracker, uint16_t percept, int bumped,
                                int rewarded)
{
    double mislocalised = tracker->action == XCSCR_NO_ACTION ? {BEGUN_ELSEWHERE} : {MISLOCALISED};
    uint16_t at;

{IGNORED}    if (!xcscr_expect(tracker{FELT})) {
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
        const int wrong = xcscr_differences(state.percept, percept)
                          + (xcscr_count(state.collected) != tracker->found);
        tracker->belief[at] = weight * xcscr_observation_error(wrong);
    }
    (void)xcscr_settle(tracker->belief);
    at = xcscr_likeliest(tracker);
    tracker->percept = at == XCSCR_GOAL ? percept : xcscr_state(at).percept;
}
";

/// The evidence about where an action has led.
pub struct Evidence {
    /// A description.
    pub words: &'static str,
    /// The parameters.
    pub types: &'static str,
    /// The arguments.
    pub names: &'static str,
    /// The condition that the state `to` fits.
    pub fits: &'static str,
    /// A statement that suppresses the compiler's warning about an unused parameter.
    pub ignored: &'static str,
}

/// The percept in the next state.
pub const PERCEIVED: Evidence = Evidence {
    words: "Adds the successor of an action if it has this percept and this number of collected rewards.",
    types: ", uint16_t percept, uint8_t found",
    names: ", percept, found",
    fits: " && xcscr_looks(to, percept, found)",
    ignored: "",
};

/// Only whether the robot has moved.
pub const BUMPED: Evidence = Evidence {
    words: "Adds the successor of an action if it fits whether the robot bumped into a wall.",
    types: ", int bumped",
    names: ", bumped",
    fits: " && (to == from) == bumped",
    ignored: "",
};

/// No evidence.
pub const NOTHING: Evidence = Evidence {
    words: "Adds the successor of an action.",
    types: "",
    names: "",
    fits: "",
    ignored: "    (void)bumped;\n",
};
