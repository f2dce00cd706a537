//! The policy over the maze as a picture: Figure 5 of the paper, and how it forms over episodes.

mod arrow;
mod drawing;
mod files;
mod animation;
mod glyphs;
mod map_preview;
mod moving_png;
mod pixels;
mod shapes;
mod svg;

pub use animation::{Animation, FilmError, Moment, Scenes};
pub(crate) use arrow::{NO_GOAL, SCALE};
pub use map_preview::map_preview;
