//! A state estimator with a map: cells that share a percept are told apart by where the robot has come from.
//!
//! * [`map_set`] keeps a map hypothesis around each goal that can be told from the others. Maps are re-estimated from
//!   the kept episodes, each aligned with the map by [`association`] (forward-backward over cells).
//! * [`tracker`] tracks the belief about the robot's cell, and encodes percept, likeliest cell, collected rewards and
//!   the last two steps as the context that rules match.
//! * [`state_map`] turns the map into the states of a POMDP. A cell that pays once in an episode is part of the state.
//!
//! Built in are: the first sixteen bits of a percept are the eight cells around the robot (free, wall, goal); a move goes
//! one cell its way unless there is a wall; cells pay once; the world stands still. Learned are the maps, how often moves
//! slip, how often cells are misread, and with `map.motion_model = "learned"` the motion model ([`motion_model`]). A bump is
//! felt and never misread, unless `map.feels_bumps` is off: then it is inferred as well ([`bump`]).
//!
//! A lidar sees no goals, so a map begins where its episodes ended. Corners between two walls are hidden from it, and
//! count neither for nor against a cell ([`Vision`]).

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
pub mod state_map;
pub mod tracker;

pub use params::{MapParams, MotionPrior};
pub use place::Vision;
pub use state_map::{Map, RewardScale};
pub use tracker::{BEGUN_ELSEWHERE, CONTEXT_BITS, MISLOCALISED, PERCEPT_BITS, Tracker, words};
