//! Parameters and switches of `xcscr-plus` and `r-max`.

use xcs::settings;

settings! {
    section "plus";

    /// Parts of `xcscr-plus` and `r-max`, each with its switch. `repair` is read by `xcscr-plus` only. Rewards, discount
    /// and step threshold are those of all methods (`reward.*`).
    pub struct PlusParams {
        /// Correct rules by guided covering where experience contradicts them: after a collision or a second visit of a
        /// place while the rules decide, in the percepts that were visited at the end of an episode, and in all known
        /// percepts after a failure.
        repair: bool = true;
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
