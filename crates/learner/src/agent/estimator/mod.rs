//! Which state the robot is in: the percept is the state, or a cell of a map that the learner draws itself.

pub mod aliasing;
pub mod belief;
pub mod map;
