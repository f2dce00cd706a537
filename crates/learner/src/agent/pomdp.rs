//! Mazes with hidden states, beliefs over these states, and a planner on beliefs.

pub use super::estimator::belief::{Belief, NEGLIGIBLE};
pub use super::model::pomdp::{GOAL, Pomdp};
pub use super::model::rewards::RewardModel;
pub use super::planner::rtdp_bel::{BeliefPlanner, Costs, Effort, MOST_BELIEFS, moved};
