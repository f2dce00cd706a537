//! Pictures of the policy over the maze (Figure 5 of the paper), and animations of how it forms.

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
