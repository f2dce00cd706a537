//! The places in which the robot was, by what they look like: what came of each action there
//! ([`known`]), and in which of them it believes to be ([`belief`]).

mod belief;
mod known;

pub use belief::{Belief, NEGLIGIBLE};
pub use known::{Came, NEAR, OPEN, Places, distance};
