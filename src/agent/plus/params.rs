//! Parameters and switches of `xcscr-plus`.

use serde::{Deserialize, Serialize};

use xcs::bounds::{OutOfRange, within};

/// How rules are discovered from lessons.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Discovery {
    /// By induction: rules that agree with all lessons.
    #[default]
    Induction,
    /// By XCS with its genetic algorithm, paid for right answers.
    Ga,
}

/// Parts of `xcscr-plus`, each with its switch. Rewards, discount and step-threshold are those of
/// all methods (`reward.*`), the greatest population is that of XCS (`xcs.population_size`).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PlusParams {
    /// How rules are discovered: `induction` or `ga`.
    pub discovery: Discovery,
    /// Does exploration follow a plan toward untried actions? If not, it is random (p_explr).
    pub planned_exploration: bool,
    /// Do general rules learned from bumps spare later ones?
    pub collision_rules: bool,
    /// Do bumps of one action tell about the others, turned?
    pub turned_rules: bool,
    /// Do general rules about ways back spare trying them in every cell?
    pub return_rules: bool,
    /// The power to which the forecast of a collision (a share of votes) is raised before it is
    /// believed; 1 to 1000. At 1, votes that are not yet sorted out send the robot on detours.
    pub certainty: u32,
}

impl Default for PlusParams {
    fn default() -> Self {
        Self {
            discovery: Discovery::Induction,
            planned_exploration: true,
            collision_rules: true,
            turned_rules: true,
            return_rules: true,
            certainty: 32,
        }
    }
}

impl PlusParams {
    /// Accepts the parameters when each lies in its range.
    ///
    /// # Errors
    /// The first parameter that does not.
    pub fn check(&self) -> Result<(), OutOfRange> {
        within("plus.certainty", self.certainty, 1..=1000)
    }
}
