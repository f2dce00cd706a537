//! Pictures of the policy over the maze (Figure 5 of the paper).

mod colours;
mod drawing;
mod map_preview;
mod pixels;
mod policy_picture;
mod svg;

pub(crate) use colours::{NO_GOAL, SCALE, css};
pub use map_preview::map_preview;
pub(crate) use pixels::{FONT, png};
pub use policy_picture::PolicyPicture;
