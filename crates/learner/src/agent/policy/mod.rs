//! Policies over percepts: what chooses where nothing is left to explore.

pub mod contexts;
pub mod distillation;
pub mod demands;
pub mod examples;
pub mod plan;
pub mod rollouts;
mod rules;

pub(super) use rules::RulePolicy;

/// What chooses the actions that exploit what was planned. It is the whole difference between
/// `xcscr-plus` and `r-max`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PolicyKind {
    /// Rules into which the decisions of the plan are distilled.
    Rules,
    /// The plan itself, with one row per state.
    Plan,
}
