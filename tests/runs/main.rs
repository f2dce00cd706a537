//! The program as its users run it, on whatever files, disks and arguments.

#![allow(clippy::unwrap_used, reason = "a test ends there")]

#[path = "../kit/mod.rs"]
mod kit;

#[cfg(unix)]
mod budget;
mod docs;
mod escapes;
mod faults;
mod forged;
mod hostile;
mod mistakes;
mod overwriting;
mod resume;
mod robots;
mod robustness;
mod train;
mod unread;
mod warnings;
mod wide_percepts;
