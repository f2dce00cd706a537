//! Parameters and switches of `xcscr-plus` and `r-max`.

use serde::{Deserialize, Serialize};

use xcs::settings;

/// What the state is taken for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Estimator {
    /// The percept, until experience contradicts that; then the cell on a map.
    #[default]
    Auto,
    /// The percept.
    Percept,
    /// The cell on a map that the learner draws.
    Map,
}

settings! {
    section "plus";

    /// Parts of `xcscr-plus` and `r-max`, each with its switch. Rewards, discount and step-threshold are those of
    /// all methods (`reward.*`), the greatest population is that of XCS (`xcs.population_size`).
    pub struct PlusParams {
        /// What the state is taken for: `percept`, the percept; `map`, the cell on a map that the learner draws;
        /// `auto`, the percept until experience contradicts that, then the cell.
        estimator: Estimator = Estimator::Auto;
        /// Does exploration follow a plan toward untried actions? If not, it is random (p_explr).
        planned_exploration: bool = true;
        /// Do general rules learned from bumps spare later ones?
        collision_rules: bool = true;
        /// Do bumps of one action tell about the others, turned?
        turned_rules: bool = true;
        /// Do general rules about ways back spare trying them in every cell?
        return_rules: bool = true;
        /// The power to which the forecast of a collision (a share of votes) is raised before it is
        /// believed. At 1, votes that are not yet sorted out send the robot on detours.
        certainty: u32 = 32, in 1..=1000;
    }
}
