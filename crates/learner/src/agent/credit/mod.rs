//! Credit assignment: standard XCS, and the mechanisms of the paper.

mod combined;
mod experts;
mod imprinting;
mod learning_rate;
mod short_term_filter;
mod stack;
mod standard;
mod step_threshold;

pub use combined::Combined;
pub use standard::Standard;

use crate::agent::StepCredit;
use xcs::{ActionSet, MatchSet, Xcs};

/// Describes a step from its \[M\] and \[A\], before any update.
pub(super) fn step_credit(
    xcs: &Xcs,
    match_set: &MatchSet,
    action_set: &ActionSet,
    short_term_reward: f64,
) -> StepCredit {
    let (size, error) = xcs.size_and_error(action_set);
    StepCredit {
        fired: xcs.strongest(action_set).map(|rule| rule.condition),
        short_term_reward,
        error,
        match_set: match_set.micro(),
        action_set: size,
    }
}
