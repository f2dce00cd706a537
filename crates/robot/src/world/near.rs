//! World files that a missing one may have been meant to be.

use std::path::{Path, PathBuf};

use super::bundled::bundled_worlds;

/// Names are alike from this likeness on.
const LEAST: f64 = 0.8;
/// No more than these are named.
const MOST: usize = 3;

/// Worlds of names like that of a missing one, the most similar first: files beside it, and bundled worlds.
pub fn worlds(missing: &Path) -> Vec<PathBuf> {
    let wanted = stem(missing);
    let mut near = alike(missing, missing.parent().unwrap_or(Path::new("")));
    let bundled =
        bundled_worlds().map(|name| (strsim::jaro_winkler(&wanted, name), PathBuf::from(name)));
    near.extend(bundled.filter(|(likeness, _)| *likeness > LEAST));
    near.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(&b.1)));
    near.into_iter().take(MOST).map(|(_, path)| path).collect()
}

/// The name of a file without its extension, in small letters.
fn stem(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default();
    stem.to_string_lossy().to_lowercase()
}

/// The worlds of a folder whose names are like that of `missing`, and how much.
fn alike(missing: &Path, folder: &Path) -> Vec<(f64, PathBuf)> {
    let wanted = stem(missing);
    let listed = match folder.as_os_str().is_empty() {
        true => Path::new("."),
        false => folder,
    };
    let entries = listed.read_dir().into_iter().flatten().flatten();
    let paths = entries.map(|entry| folder.join(entry.file_name()));
    let worlds = paths.filter(|path| path.extension().is_some_and(|end| end == "json"));
    let ranked = worlds.map(|path| (strsim::jaro_winkler(&wanted, &stem(&path)), path));
    ranked.filter(|(likeness, _)| *likeness > LEAST).collect()
}
