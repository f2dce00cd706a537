//! Constants of the planner on beliefs about hidden states.

pub use super::estimator::belief::NEGLIGIBLE;
pub use super::model::pomdp::GOAL;
pub use super::planner::rtdp_bel::MOST_BELIEFS;

pub(crate) use super::estimator::belief::Belief;
pub(crate) use super::model::pomdp::Pomdp;
pub(crate) use super::planner::rtdp_bel::{BeliefPlanner, moved};
