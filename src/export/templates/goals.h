/* Returns 1 if a cell is a goal. */
static inline int xcscr_is_goal(int32_t column, int32_t row)
{
    uint16_t at;

    for (at = 0; at < XCSCR_GOALS; at++) {
        uint16_t goal_column;
        uint16_t goal_row;
        XCSCR_READ(goal_column, xcscr_goals[at][0]);
        XCSCR_READ(goal_row, xcscr_goals[at][1]);
        if (goal_column == column && goal_row == row) {
            return 1;
        }
    }
    return 0;
}
