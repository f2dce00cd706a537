//! Parameters and switches of `xcscr-plus` and `r-max`.

use xcs::settings;

settings! {
    section "plus";

    /// Parts of `xcscr-plus` and `r-max`, each with its switch. `replay` and `guided_covering` are read by `xcscr-plus`
    /// only. Rewards, discount and step threshold are those of all methods (`reward.*`).
    pub struct PlusParams {
        /// Replay known percepts after each step, with the reward of a success for the best actions of the plan. Without
        /// it, there is no guided covering either.
        replay: bool = true;
        /// Add the most general rules that no known percept contradicts: at the end of an episode, and after a step for
        /// the next percept if the rules disagree with the plan there.
        guided_covering: bool = true;
        /// Explore along planned paths toward untried actions. Without it, exploration is random
        /// (p_explr).
        planned_exploration: bool = true;
        /// Learn general collision rules, so that predicted collisions are not tried.
        collision_rules: bool = true;
        /// Apply collisions of one action to the other actions by rotational symmetry.
        turned_rules: bool = true;
        /// Learn inverse-action rules, so that predicted returns are not tried in every cell.
        return_rules: bool = true;
    }
}
