//! Serving recordings to viewers: finished files over HTTP, and live streams of running runs.

mod byte_range;
mod listener;
mod connection;
mod head;
pub mod server;
