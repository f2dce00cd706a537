#![doc = include_str!("../README.md")]
#![warn(clippy::unwrap_used, clippy::print_stdout, clippy::print_stderr)]

pub mod streams;
pub mod input;
pub mod world;
pub mod arena;
pub mod sensor;
