//! A mobile robot in a physics-simulated maze that learns readable rules.

#![warn(clippy::print_stdout, clippy::print_stderr)]

// In flow order, which is the import order; `tests/layering.rs` watches over it.
pub mod signal;
pub mod random;
pub mod bounds;
pub mod world;
pub mod arena;
pub mod sensor;
pub mod xcs;
pub mod reward;
pub mod episode;
pub mod record;
pub mod study;
