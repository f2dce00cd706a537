//! Where the robot may be, in C99: once for percepts that are right, once for those that may be misread.

/// Does a state look like what is perceived?
pub const LOOKS: &str = r"
/* Does a state look like this, and were so many rewards found in it? */
static inline int xcscr_looks(uint16_t at, uint16_t percept, uint8_t found)
{
    const struct xcscr_state state = xcscr_state(at);
    return state.percept == percept && xcscr_count(state.collected) == found;
}
";

/// What is believed when percepts are right.
pub const LOCATE_RIGHTLY: &str = r"
static inline void xcscr_believe_next(struct xcscr_tracker *tracker, uint8_t found)
{
    uint16_t at;

    tracker->found = found;
    for (at = 0; at < XCSCR_STATES; at++) {
        tracker->belief[at] = tracker->next[at];
    }
}

/* Do all states that are believed look like this? */
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

/* Believes in all states that look most like this. */
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

/* Where the robot may be. That it bumped shows in what it perceives. */
static inline void xcscr_locate(struct xcscr_tracker *tracker, uint16_t percept, int bumped,
                                int rewarded)
{
    const uint8_t found = (uint8_t)(tracker->found + (rewarded != 0));
    /* A reward that was not predicted, or did not come, still tells where the robot is. */
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

/// What is believed when percepts may be misread.
pub const LOCATE_DOUBTINGLY: &str = r"
/* What is expected before anything is perceived, if anything is. */
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

/* How likely it is to observation_error so many cells. */
static inline double xcscr_observation_error(int cells)
{
    double likely = 1.0;

    for (; cells > 0; cells--) {
        likely *= XCSCR_OBSERVATION_ERROR;
    }
    return likely;
}

/* Where the robot may be: all states weighed by what was expected, and by how much of what is perceived
 * would be wrong there. With a small probability it is anywhere. */
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

/// What is known of where an action has led.
pub struct Felt {
    /// In words.
    pub words: &'static str,
    /// As parameters.
    pub types: &'static str,
    /// As arguments.
    pub names: &'static str,
    /// Does the state `to` fit?
    pub fits: &'static str,
    /// A statement without which the compiler warns that something is not looked at.
    pub ignored: &'static str,
}

/// What is perceived there.
pub const PERCEIVED: Felt = Felt {
    words: "Where executing an action in a state leads, if it looks like this there after so many rewards.",
    types: ", uint16_t percept, uint8_t found",
    names: ", percept, found",
    fits: " && xcscr_looks(to, percept, found)",
    ignored: "",
};

/// Only whether the robot stands where it was.
pub const BUMPED: Felt = Felt {
    words: "Where executing an action in a state leads: elsewhere, or nowhere if the robot bumped.",
    types: ", int bumped",
    names: ", bumped",
    fits: " && (to == from) == bumped",
    ignored: "",
};

/// Nothing.
pub const NOTHING: Felt = Felt {
    words: "Where executing an action in a state leads.",
    types: "",
    names: "",
    fits: "",
    ignored: "    (void)bumped;\n",
};
