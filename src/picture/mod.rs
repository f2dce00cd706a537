//! The policy over the maze as a picture: Figure 5 of the paper, and how it forms over episodes.

mod arrow;
mod drawing;
mod files;
mod film;
mod letters;
mod map_preview;
mod moving_png;
mod pixels;
mod shapes;
mod svg;

pub(crate) use arrow::{NO_GOAL, SCALE};
pub use film::{Film, FilmError, Moment, Scenes};
pub use map_preview::map_preview;
