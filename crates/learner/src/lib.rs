#![doc = include_str!("../README.md")]
#![warn(clippy::unwrap_used, clippy::print_stdout, clippy::print_stderr)]

pub mod agent;
pub mod episode;
pub mod trial;
