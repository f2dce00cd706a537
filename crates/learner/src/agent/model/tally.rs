//! What speaks for a collision, and what against it.

use serde::{Deserialize, Serialize};

/// A candidate is dropped when fewer of its forecasts than this came true.
const LEAST_ACCURACY: f64 = 0.9;
/// Counts in files lie below this, so that there is room to count on.
const MOST_COUNTED: u32 = u32::MAX / 4;

/// Percepts in which an action bumped, and in which it moved.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(in crate::agent) struct Tally {
    pub hits: u32,
    pub misses: u32,
}

impl Tally {
    pub(super) fn is_accurate(self) -> bool {
        let all = f64::from(self.hits + self.misses);
        self.hits > 0 && f64::from(self.hits) >= LEAST_ACCURACY * all
    }

    pub(super) fn add(&mut self, verdict: Option<bool>) {
        match verdict {
            Some(true) => self.hits += 1,
            Some(false) => self.misses += 1,
            None => {}
        }
    }

    pub(super) fn take_back(&mut self, verdict: Option<bool>) {
        match verdict {
            Some(true) => self.hits = self.hits.saturating_sub(1),
            Some(false) => self.misses = self.misses.saturating_sub(1),
            None => {}
        }
    }

    pub fn is_sound(self) -> bool {
        self.hits <= MOST_COUNTED && self.misses <= MOST_COUNTED
    }
}

/// Does a percept count as one where the action bumps? `None` where nothing is known, or where neither
/// is ahead by this margin.
pub(super) fn verdict(Tally { hits, misses }: Tally, margin: u32) -> Option<bool> {
    (hits + misses > 0 && hits.abs_diff(misses) >= margin).then_some(hits > misses)
}
