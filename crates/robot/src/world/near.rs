//! Suggests world files for a missing one.

use std::path::{Path, PathBuf};

use super::bundled::bundled_worlds;

/// The smallest similarity of two similar names.
const MIN_SIMILARITY: f64 = 0.8;
/// The largest number of suggestions.
const MAX_SUGGESTIONS: usize = 3;

/// Returns worlds with names similar to a missing one, the most similar first: files in the same
/// folder, and bundled worlds.
pub fn worlds(missing: &Path) -> Vec<PathBuf> {
    let wanted = stem(missing);
    let mut near = similar(missing, missing.parent().unwrap_or(Path::new("")));
    let bundled =
        bundled_worlds().map(|name| (strsim::jaro_winkler(&wanted, name), PathBuf::from(name)));
    near.extend(bundled.filter(|(similarity, _)| *similarity > MIN_SIMILARITY));
    near.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(&b.1)));
    near.into_iter()
        .take(MAX_SUGGESTIONS)
        .map(|(_, path)| path)
        .collect()
}

/// Returns the name of a file without its extension, in lower case.
fn stem(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default();
    stem.to_string_lossy().to_lowercase()
}

/// Returns the worlds of a folder whose names are similar to `missing`, each with its similarity.
fn similar(missing: &Path, folder: &Path) -> Vec<(f64, PathBuf)> {
    let wanted = stem(missing);
    let listed = match folder.as_os_str().is_empty() {
        true => Path::new("."),
        false => folder,
    };
    let entries = listed.read_dir().into_iter().flatten().flatten();
    let paths = entries.map(|entry| folder.join(entry.file_name()));
    let worlds = paths.filter(|path| path.extension().is_some_and(|end| end == "json"));
    let ranked = worlds.map(|path| (strsim::jaro_winkler(&wanted, &stem(&path)), path));
    ranked
        .filter(|(similarity, _)| *similarity > MIN_SIMILARITY)
        .collect()
}
