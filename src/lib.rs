//! A mobile robot in a physics-simulated maze that learns readable rules.

#![warn(clippy::print_stdout, clippy::print_stderr)]

pub mod arena;
pub mod bounds;
pub mod episode;
pub mod random;
pub mod record;
pub mod reward;
pub mod sensor;
pub mod signal;
pub mod world;
pub mod xcs;
