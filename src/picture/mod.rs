//! Pictures of worlds (Figure 3 of the paper), of the policy, and of the values behind it (Figures 2 and 5).

mod action_values;
mod camera;
pub(crate) mod chart;
mod colours;
mod drawing;
mod map_preview;
mod policy_picture;
mod shortest;
pub(crate) mod svg;
mod true_walls;

pub(crate) use camera::{Camera, Stages};
pub(crate) use colours::css;
pub(crate) use drawing::{PAPER, block};
pub use map_preview::map_preview;
pub use policy_picture::{Look, PolicyPicture, world_picture};
