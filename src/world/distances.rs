//! The distances of a maze, kept with it.

use std::sync::{Arc, OnceLock};

/// By cell index, computed when they are first asked for and shared by all clones of a maze; what
/// the numbers mean is up to [`Paths`](super::Paths). They follow from the rest of the maze, so they
/// tell no two apart.
#[derive(Debug, Clone, Default)]
pub(super) struct Distances(OnceLock<Arc<[u32]>>);

impl Distances {
    /// The distances, from `search` if nobody asked before.
    pub fn or_search(&self, search: impl FnOnce() -> Vec<u32>) -> Arc<[u32]> {
        Arc::clone(self.0.get_or_init(|| search().into()))
    }
}

impl PartialEq for Distances {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}
