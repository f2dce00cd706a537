//! The episode loop, its observers, and the resulting policy.

mod choices;
mod mistakes;
mod observer;
mod params;
mod policy;
mod run;

pub(crate) use choices::BestChoices;
pub use mistakes::MistakeCounter;
pub use mistakes::Mistakes;
pub use observer::{AfterEpisode, Ending, Episode, Observer, Step};
pub use params::Params;
pub(crate) use policy::FaultFinder;
pub use policy::{PolicyMap, greedy_path};
pub use run::{Start, run};
