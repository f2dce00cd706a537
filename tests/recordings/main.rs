//! Recordings: what they must be, what becomes of broken ones, and how they are looked at.

#![allow(clippy::unwrap_used, reason = "a test ends there")]

#[path = "../kit/mod.rs"]
mod kit;

mod checking;
mod external;
mod forged_recordings;
#[cfg(feature = "live")]
mod live;
mod long_highlights;
mod page;
mod recording;
mod recording_faults;
mod recovery;
mod robots;
mod ros;
mod schemas;
mod serving;
mod size;
mod highlights;
mod watching;
