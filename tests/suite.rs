//! All tests in one program, because each program links the whole of xcscr.
//!
//! `cargo test` runs the fast suite, which asks every promise once. With the feature `long` the same
//! program also has the long suite: kills, mutants, full products and large samples.

#![allow(clippy::unwrap_used, reason = "a test ends there")]
#![cfg_attr(
    not(feature = "long"),
    allow(dead_code, unused_imports, reason = "the long suite uses the rest")
)]

mod kit;

mod golden;
mod learner;
mod recordings;
mod runs;
mod settings;
mod study;
mod world;
