//! What is told in headings, paragraphs, tables and pictures: for a terminal, as Markdown, or as
//! one HTML page that needs nothing else.

mod blocks;
mod html;

pub use blocks::{Block, Picture, Table};
pub(crate) use blocks::{markdown, terminal, without_tags};
pub(crate) use html::escaped;
pub use html::html;
