//! The test kit: the program, its server, folders, random numbers, and small trials. Each test uses
//! a part of it.

#![allow(dead_code, reason = "each test file uses a part")]
#![allow(clippy::unwrap_used, reason = "a test ends there")]

pub mod chance;
pub mod desk;
pub mod flat;
pub mod folder;
pub mod messages;
pub mod mutants;
pub mod program;
pub mod script;
pub mod scripted;
pub mod served;
pub mod tally;
pub mod trial;
