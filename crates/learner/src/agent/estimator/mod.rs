//! State estimators: the percept itself is the state, or the state is a cell of a learned map.

pub mod aliasing;
pub mod belief;
pub mod map;
