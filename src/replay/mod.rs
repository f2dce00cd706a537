//! Shows recordings: as a page that plays them, and on a server for Foxglove and Lichtblick.

pub mod player;
mod serve;

pub use serve::server;
