//! A state estimator with a map: cells that share a percept are told apart.
//!
//! The robot keeps charts of the world, one around each goal that it can tell from the others
//! ([`atlas`]), drawn from episodes that reached it ([`align`]). On them it tracks where it may be
//! ([`context`]), plans ([`crate::agent::model::pomdp`]) and imagines episodes, which make lessons
//! ([`lessons`]). From these \[P\] learns as it does in `xcscr-plus`, by [`xcs::Induction`]: a rule that is wrong in a
//! lesson demands more or goes, a lesson that no rule covers gets one, and rules that others make superfluous go; all others
//! stay ([`course`]). What rules meet when they drive makes lessons, too, and each keeps a record of how often it acted and was
//! right. **The rules act**: they look at the percept and, each only where that is not enough, at the
//! likeliest place on the charts with what was found there in this episode, and at the last two steps
//! ([`context::PARTS`]). Charts and plan teach them, and say what to explore ([`wander`]): what is new in a sketch of
//! where the robot has been in this episode or, as long as all seem to begin in one place, in any.
//!
//! Cells that pay by themselves are remembered ([`payments`]), and that they pay once in an episode is
//! part of the state ([`map`]). While none is known the plan is the one of the fewest steps; with them
//! it is the one of the greatest discounted sum of all rewards, which may be a detour.
//!
//! Through a lidar no goal is seen: a chart begins where its episodes ended. Corners between two walls
//! are hidden from it, and count neither for nor against a place ([`Vision`]). If episodes always begin in
//! one place, the robot learns that ([`Map::begin`]).
//!
//! The baseline `r-max` has the same maps, belief and plan, but no rules: the plan acts ([`Decider::Plan`]).
//!
//! Built in are that the first sixteen bits of a percept are the eight cells around the robot, what
//! the letters mean (free, wall, goal), that a move goes one cell its way unless there is a wall, that
//! cells pay once, and that the world stands still. Learned are charts, slips and rules. Whether a move slipped is not
//! perceived but inferred from the percepts; that the robot bumped, and stands where it was, is felt and
//! never misread, unless `memory.bumps` is off: then that is inferred, too ([`bumped`]).
//!
//! Which way each action goes is built in, too, unless `memory.odometry` is `none`: then it is learned
//! ([`headings`]), by the theorem of Bayes, from what two percepts share that follow each other, and from
//! how each episode lies on its chart. Exploration tries an action of which nobody can tell what will come of it.
//!
//! Cells may be misread. How often is learned from what two percepts show that follow each other;
//! where it is more than a trifle, belief and charts weigh what is seen by it, the rules look at
//! what should be seen in the likeliest place instead.

mod align;
mod aliasing;
mod atlas;
mod bumped;
mod chart;
mod context;
mod course;
mod demands;
mod doubt;
mod headings;
mod layer;
pub(super) mod learner;
mod lessons;
mod likelihood;
mod map;
mod params;
mod payments;
mod place;
mod planned;
mod rehearsal;
mod samples;
mod sheet;
mod sightings;
mod wander;

pub use context::{ASTRAY, BEGUN_ELSEWHERE, CONTEXT_BITS, PERCEPT_BITS, Tracker, words};
pub use demands::{Demand, Part, demands};
pub use map::{Map, Worth};
pub use params::{MemoryParams, Odometry};
pub use place::Vision;
pub use planned::ChartedPlan;
pub use samples::contexts;
