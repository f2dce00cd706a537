/* Returns 1 if the mean values_a / weight_a is greater than values_b / weight_b. Computes in 96 bits. */
static inline int xcscr_is_greater(uint64_t values_a, uint32_t weight_a,
                                   uint64_t values_b, uint32_t weight_b)
{
    const uint64_t low_a = (values_a & 0xffffffffu) * weight_b;
    const uint64_t low_b = (values_b & 0xffffffffu) * weight_a;
    const uint64_t high_a = (values_a >> 32) * weight_b + (low_a >> 32);
    const uint64_t high_b = (values_b >> 32) * weight_a + (low_b >> 32);
    if (high_a != high_b) {
        return high_a > high_b;
    }
    return (low_a & 0xffffffffu) > (low_b & 0xffffffffu);
}

/* Returns the action with the greatest mean value among the allowed ones, the first of equals;
 * XCSCR_NO_ACTION if no rule for them matches. Bit i allows action i. Each matching rule votes for its action
 * with a weight and a value. */
static inline int8_t xcscr_decide_among(const xcscr_input *input, uint16_t allowed)
{
    uint64_t value[XCSCR_ACTIONS] = {0};
    uint32_t weight[XCSCR_ACTIONS] = {0};
    int8_t best = XCSCR_NO_ACTION;
    int8_t action;
    uint16_t at;

    for (at = 0; at < XCSCR_RULES; at++) {
        struct xcscr_rule rule;
        XCSCR_READ(rule, xcscr_rules[at]);
        if (xcscr_matches(&rule.condition, input)) {
            value[rule.action] += (uint64_t)rule.value * rule.weight;
            weight[rule.action] += rule.weight;
        }
    }
    for (action = 0; action < XCSCR_ACTIONS; action++) {
        if (weight[action] != 0 && (allowed >> action & 1) != 0
            && (best == XCSCR_NO_ACTION
                || xcscr_is_greater(value[action], weight[action], value[best], weight[best]))) {
            best = action;
        }
    }
    return best;
}

/* Returns the action with the greatest mean value of all; XCSCR_NO_ACTION if no rule matches. */
static inline int8_t xcscr_decide(const xcscr_input *input)
{
    return xcscr_decide_among(input, 0xffff);
}
