//! The episode loop.

mod observer;
mod policy;

pub use observer::{Ending, Episode, Learned, Observer, Step};
pub use policy::PolicyMap;
