//! Policies: the choice of actions when nothing is left to explore.

pub mod choice;
pub mod contexts;
pub mod demands;
pub mod distillation;
pub mod examples;
pub mod explorer;
pub mod map_rules;
pub mod plan;
pub mod rollouts;
mod rules;

pub(super) use rules::RulePolicy;

/// The policy that exploits the plan. It is the only difference between `xcscr-plus` and `r-max`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PolicyKind {
    /// Rules, distilled from the decisions of the plan.
    Rules,
    /// The plan itself, with one row per state.
    Plan,
}
