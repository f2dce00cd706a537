//! Counts of evidence for and against a collision.

/// The least share of correct forecasts of a candidate.
const LEAST_ACCURACY: f64 = 0.9;
/// The numbers of percepts in which an action bumped, and in which it moved.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
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
}

/// Returns whether the action bumps in a percept; `None` if nothing is known or the lead is below the
/// margin.
pub(super) fn verdict(Tally { hits, misses }: Tally, margin: u32) -> Option<bool> {
    (hits + misses > 0 && hits.abs_diff(misses) >= margin).then_some(hits > misses)
}
