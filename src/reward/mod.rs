//! Who is credited, with what, and when. All reward numbers live here.
//!
//! A [`RewardMethod`] is a learner with its way of handing out credit. [`Method`] is the closed
//! set of them, by the names they have on the command line.

mod adapted;
mod combined;
mod knowledge;
mod memory;
mod method;
mod mind;
mod params;
mod stack;
mod standard;

pub use adapted::Adapted;
pub use combined::Combined;
pub use knowledge::{Frozen, Knowledge, Misfit};
pub use memory::MemoryError;
pub use method::{EndCredit, RewardMethod, StepCredit};
pub use params::{Params, Sharing};
pub use standard::Standard;

use crate::random::{Stream, StreamName};
use crate::xcs::{self, Xcs};

/// The reward methods.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Standard XCS.
    Xcs,
    /// XCS adapted to robots, reward shared evenly (Eq. 7 and 8).
    AdaptedEven,
    /// XCS adapted to robots, reward discounted (Eq. 7 and 9).
    AdaptedDiscounted,
    /// The paper's combined reward method.
    Xcscr,
}

impl Method {
    /// All methods, in the order in which they are reported.
    pub const ALL: [Self; 4] = [
        Self::Xcs,
        Self::AdaptedEven,
        Self::AdaptedDiscounted,
        Self::Xcscr,
    ];

    /// The name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Xcs => "xcs",
            Self::AdaptedEven => "adapted-even",
            Self::AdaptedDiscounted => "adapted-discounted",
            Self::Xcscr => "xcscr",
        }
    }

    /// A learner that knows nothing yet, for `actions` actions. The parameters must have been
    /// checked; `seed` is the trial's root seed.
    pub fn build(
        self,
        actions: usize,
        xcs: xcs::Params,
        params: Params,
        seed: u64,
    ) -> Box<dyn RewardMethod> {
        let xcs = Xcs::new(xcs, actions, Stream::new(seed, StreamName::Evolution));
        match self {
            Self::Xcs => Box::new(Standard::new(xcs, params)),
            Self::AdaptedEven => Box::new(Adapted::new(xcs, params, Sharing::Even)),
            Self::AdaptedDiscounted => Box::new(Adapted::new(xcs, params, Sharing::Discounted)),
            Self::Xcscr => {
                let stream = Stream::new(seed, StreamName::Imprinting);
                Box::new(Combined::new(xcs, params, stream))
            }
        }
    }

    /// A learner that goes on as the one whose [`memory`](RewardMethod::memory) this is. All other
    /// arguments must be those of [`build`](Self::build).
    ///
    /// # Errors
    /// When the memory is that of another method or of other settings, or is damaged.
    pub fn restore(
        self,
        actions: usize,
        xcs: xcs::Params,
        params: Params,
        seed: u64,
        saved: &[u8],
    ) -> Result<Box<dyn RewardMethod>, MemoryError> {
        let xcs = Xcs::new(xcs, actions, Stream::new(seed, StreamName::Evolution));
        Ok(match self {
            Self::Xcs => {
                let fresh = Standard::new(xcs, params);
                Box::new(memory::recall(saved, |it: &Standard| {
                    it.descends_from(&fresh)
                })?)
            }
            Self::AdaptedEven => Box::new(recall_adapted(xcs, params, Sharing::Even, saved)?),
            Self::AdaptedDiscounted => {
                Box::new(recall_adapted(xcs, params, Sharing::Discounted, saved)?)
            }
            Self::Xcscr => {
                let fresh = Combined::new(xcs, params, Stream::new(seed, StreamName::Imprinting));
                Box::new(memory::recall(saved, |it: &Combined| {
                    it.descends_from(&fresh)
                })?)
            }
        })
    }
}

fn recall_adapted(
    xcs: Xcs,
    params: Params,
    sharing: Sharing,
    saved: &[u8],
) -> Result<Adapted, MemoryError> {
    let fresh = Adapted::new(xcs, params, sharing);
    memory::recall(saved, |it: &Adapted| it.descends_from(&fresh))
}
