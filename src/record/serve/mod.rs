//! Handing recordings to viewers: finished files over HTTP, and a run that is under way.

mod byte_range;
mod listener;
mod connection;
mod head;
#[cfg(feature = "live")]
pub mod live;
pub mod server;
