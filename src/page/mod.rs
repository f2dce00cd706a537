//! Documents of headings, paragraphs, tables and pictures, rendered for a terminal, as Markdown, or
//! as one self-contained HTML page.

mod blocks;
mod html;

pub use blocks::{Block, Picture, Table};
pub(crate) use blocks::{markdown, terminal, without_tags};
pub(crate) use html::escaped;
pub use html::html;
