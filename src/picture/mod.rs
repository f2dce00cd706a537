//! Pictures of the policy over the maze (Figure 5 of the paper), and animations of how it forms.

mod animation;
mod colours;
mod drawing;
mod map_preview;
mod moving_png;
mod pixels;
mod svg;

pub use animation::{Animation, Scenes};
pub(crate) use colours::{NO_GOAL, SCALE, css};
pub use map_preview::map_preview;
pub(crate) use pixels::{FONT, png};
