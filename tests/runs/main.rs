//! The program as its users run it, on whatever files, disks and arguments.

#![allow(clippy::unwrap_used, reason = "a test ends there")]

#[path = "../kit/mod.rs"]
mod kit;

#[cfg(unix)]
mod budget;
mod command_line;
mod config;
mod disks;
mod docs;
mod escapes;
mod extremes;
mod faults;
mod hostile;
mod overwriting;
mod interrupted;
mod resume;
mod robustness;
mod signals;
mod train;
