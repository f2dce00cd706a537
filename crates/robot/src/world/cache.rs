//! A cache of results that are derived from a maze and expensive to compute.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Computed on first use, and shared by all clones of a maze, so that a trial, its recorder and its
/// report compute them only once. The results depend only on the maze itself, so all caches compare
/// as equal.
#[derive(Debug, Clone, Default)]
pub(super) struct Cache(Arc<Results>);

#[derive(Debug, Default)]
struct Results {
    distances: OnceLock<Arc<[u32]>>,
    figures: Mutex<BTreeMap<&'static str, Option<f64>>>,
}

impl Cache {
    /// Returns the distances by cell index, and computes them with `search` on first use. The
    /// numbers are encoded as in [`Paths`](super::Paths).
    pub fn distances(&self, search: impl FnOnce() -> Vec<u32>) -> Arc<[u32]> {
        Arc::clone(self.0.distances.get_or_init(|| search().into()))
    }

    /// Returns a number about the maze, and computes it with `find` on first use. Concurrent
    /// callers wait.
    pub fn figure(&self, name: &'static str, find: impl FnOnce() -> Option<f64>) -> Option<f64> {
        let figures = self.0.figures.lock();
        let mut figures = figures.unwrap_or_else(PoisonError::into_inner);
        *figures.entry(name).or_insert_with(find)
    }
}

impl PartialEq for Cache {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}
