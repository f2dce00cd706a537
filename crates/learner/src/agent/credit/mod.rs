//! Credit assignment: standard XCS, and the mechanisms of the paper.

mod combined;
mod experts;
mod imprinting;
mod learning_rate;
pub mod params;
mod policy;
mod short_term_filter;
mod stack;
mod standard;
mod step_threshold;

pub use combined::Combined;
pub use params::{Params, Sharing, StackEvolution, StepLimitUpdate, XcsPayment};
pub use standard::Standard;

use crate::agent::StepCredit;
use xcs::{Action, ActionSet, MatchSet, Percept, Population, Xcs};

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
        filtered: None,
    }
}

/// Describes the rules that match a percept, and those of them that advocate an action.
pub(super) fn credit_of_rules(rules: &Population, percept: &Percept, action: Action) -> StepCredit {
    let mut credit = StepCredit::default();
    let (mut error, mut fitness, mut greatest) = (0.0, 0.0, f64::NEG_INFINITY);
    rules.for_each_match(percept, |_, rule| {
        credit.match_set += rule.numerosity;
        if rule.action != action {
            return;
        }
        credit.action_set += rule.numerosity;
        error += rule.error * rule.fitness;
        fitness += rule.fitness;
        if rule.fitness > greatest {
            greatest = rule.fitness;
            credit.fired = Some(rule.condition);
        }
    });
    if fitness > 0.0 {
        credit.error = error / fitness;
    }
    credit
}
