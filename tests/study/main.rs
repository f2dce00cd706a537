//! Studies: whole, in tasks; interrupted, mixed up, and on files that come late.

#![allow(clippy::unwrap_used, reason = "a test ends there")]

#[path = "../kit/mod.rs"]
mod kit;

mod desk;
mod episodes;
mod extension;
mod late_files;
mod own_agents;
mod reports;
#[cfg(unix)]
mod sharing;
mod studies;
#[cfg(unix)]
mod tasks;
