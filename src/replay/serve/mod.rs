//! A server on this machine, from which viewers in a browser load recordings.

mod byte_range;
mod listener;
mod connection;
mod head;
pub mod server;
