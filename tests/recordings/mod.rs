//! Recordings: what they must be, what becomes of broken ones, and how they are looked at.

/// Arguments of `train` for the runs that most tests look at.
const PHYSICS: &str = "maze4 --episodes 5";
const GRID: &str = "maze4 --arena grid --episodes 12";
const OTHER: &str = "maze4 --arena grid --episodes 12 --seed 2";

mod checking;
mod copies;
mod external;
mod forged_recordings;
#[cfg(feature = "long")]
mod methods;
mod page;
mod recording;
mod serving;
mod summaries;
mod watching;
