//! Handing recordings to viewers: finished files over HTTP, and a run that is under way.

mod byte_range;
mod gate;
mod guest;
mod head;
#[cfg(feature = "live")]
pub mod live;
pub mod server;
