//! Which action is best: prioritised sweeping over percepts, RTDP-Bel over beliefs; and where to explore.

pub mod exploration;
pub mod frontier;
pub mod rtdp_bel;
pub mod sweeping;
