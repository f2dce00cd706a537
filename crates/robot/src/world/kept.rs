//! What follows from a maze and takes long to find, kept with it.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Found when it is first asked for, and shared by all clones of a maze, so that a trial, its
/// recorder and its report do not search again. It follows from the rest of the maze, so it tells
/// no two apart.
#[derive(Debug, Clone, Default)]
pub(super) struct Kept(Arc<Found>);

#[derive(Debug, Default)]
struct Found {
    distances: OnceLock<Arc<[u32]>>,
    figures: Mutex<BTreeMap<&'static str, Option<f64>>>,
}

impl Kept {
    /// The distances by cell index, from `search` if nobody asked before; what the numbers mean is
    /// up to [`Paths`](super::Paths).
    pub fn distances(&self, search: impl FnOnce() -> Vec<u32>) -> Arc<[u32]> {
        Arc::clone(self.0.distances.get_or_init(|| search().into()))
    }

    /// A figure about the maze, from `find` if nobody asked for it before. Who asks at the same
    /// time waits.
    pub fn figure(&self, name: &'static str, find: impl FnOnce() -> Option<f64>) -> Option<f64> {
        let figures = self.0.figures.lock();
        let mut figures = figures.unwrap_or_else(PoisonError::into_inner);
        *figures.entry(name).or_insert_with(find)
    }
}

impl PartialEq for Kept {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}
