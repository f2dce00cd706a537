//! Planners over percepts: prioritised sweeping, and planned exploration.

pub mod exploration;
pub mod sweeping;
