//! Parameters and switches of `xcscr-plus` and `r-max`.

use crate::agent::estimator::Estimator;
use xcs::settings;

settings! {
    section "plus";

    /// Parts of `xcscr-plus` and `r-max`, each with its switch. Rewards, discount and step-threshold are those of all
    /// methods (`reward.*`). The maximum population size is that of XCS (`xcs.population_size`).
    pub struct PlusParams {
        /// What represents the state. `percept`: the percept. `map`: the cell on a map that the learner builds.
        /// `auto`: the percept until experience contradicts this, then the cell.
        estimator: Estimator = Estimator::Auto;
        /// Explore along planned paths toward untried actions. Without it, exploration is random
        /// (p_explr).
        planned_exploration: bool = true;
        /// Learn general collision rules, so that predicted collisions are not tried.
        collision_rules: bool = true;
        /// Apply collisions of one action to the other actions by rotational symmetry.
        turned_rules: bool = true;
        /// Learn inverse-action rules, so that predicted returns are not tried in every cell.
        return_rules: bool = true;
        /// The power to which the predicted probability of a collision (a share of votes) is raised
        /// before use. At 1, undecided votes cause detours.
        certainty: u32 = 32, in 1..=1000;
    }
}
