//! Suggests worlds for a missing file.

use std::path::{Path, PathBuf};

use super::bundled::bundled_worlds;

/// The smallest similarity of two similar names.
const MIN_SIMILARITY: f64 = 0.8;
/// The largest number of suggestions.
const MAX_SUGGESTIONS: usize = 3;

/// Returns bundled worlds with names similar to a missing one, the most similar first.
pub fn worlds(missing: &Path) -> Vec<PathBuf> {
    let stem = missing.file_stem().unwrap_or_default();
    let wanted = stem.to_string_lossy().to_lowercase();
    let names = bundled_worlds().map(|name| (strsim::jaro_winkler(&wanted, name), name));
    let mut near: Vec<_> = names
        .filter(|(similarity, _)| *similarity > MIN_SIMILARITY)
        .collect();
    near.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(b.1)));
    near.into_iter()
        .take(MAX_SUGGESTIONS)
        .map(|(_, name)| PathBuf::from(name))
        .collect()
}
