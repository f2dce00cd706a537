//! Planners: prioritised sweeping over percepts, RTDP-Bel over beliefs, and exploration.

pub mod exploration;
pub mod frontier;
pub mod rtdp_bel;
mod simulation;
pub mod sweeping;
