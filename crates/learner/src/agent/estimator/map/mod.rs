//! A state estimator with a map. It distinguishes cells with the same percept by the robot's path.
//!
//! * [`map_set`] keeps a map hypothesis around each distinguishable goal. It re-estimates the maps from
//!   the stored episodes, which [`association`] aligns with the map (forward-backward over cells).
//! * [`tracker`] tracks the belief about the robot's cell. It encodes percept, likeliest cell, collected
//!   rewards and the last two steps as the context that rules match.
//! * [`state_map`] turns the map into the states of a POMDP. Whether a rewarded cell was collected in the
//!   episode is part of the state.
//!
//! Built-in assumptions: the first sixteen bits of a percept are the eight cells around the robot (free,
//! wall, goal). A move leads one cell in its direction unless a wall is there. A cell pays its reward
//! once per episode. The world does not change.
//!
//! Learned are the maps, the slip probability and the observation error. With
//! `map.motion_model = "learned"`, the motion model is learned as well ([`motion_model`]). The bumper is
//! free of errors. If `map.feels_bumps` is off, bumps are inferred ([`bump`]).
//!
//! A lidar cannot see goals, so a map starts where its episodes ended. Corners between two walls are
//! hidden from it, and count neither for nor against a cell ([`Vision`]).

pub mod association;
pub mod bump;
pub mod cell_counts;
pub mod hypothesis;
mod likelihood;
pub mod map_set;
mod messages;
pub mod motion_model;
mod noise;
mod observations;
mod params;
pub mod place;
mod reward_map;
pub mod robot_model;
pub mod state_map;
pub mod tracker;

pub use params::{MapParams, MotionPrior};
pub use place::Vision;
pub use state_map::Map;
pub use tracker::{BEGUN_ELSEWHERE, CONTEXT_BITS, MISLOCALISED, PERCEPT_BITS, Tracker};
