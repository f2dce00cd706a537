//! What is learned, how, how well, and what becomes of it.

#![allow(clippy::unwrap_used, reason = "a test ends there")]

#[path = "../kit/mod.rs"]
mod kit;

mod advice;
mod auxiliary;
mod ceilings;
mod driving;
mod examples;
mod exporting;
mod knowledge;
mod learned;
mod lidar;
mod memory;
mod noise;
mod odometry;
mod paper;
mod readings;
mod readme;
mod rival;
mod rules;
mod rules_decide;
mod trust;
mod unread;
mod xcs_invariants;
