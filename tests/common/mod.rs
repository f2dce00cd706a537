//! What several tests share. Not every test uses all of it.
#![allow(dead_code)]
#![allow(clippy::unwrap_used, reason = "a test ends there")]

pub mod scripted;
pub mod trial;
