//! World files that a missing one may have been meant to be.

use std::path::{Path, PathBuf};

/// Where the worlds lie that come with the program.
const SHIPPED: &str = "worlds";
/// No more than these are named.
const MOST: usize = 3;

/// World files of names like that of a missing one, the most similar first: beside it, and among
/// those that come with the program.
pub fn worlds(missing: &Path) -> Vec<PathBuf> {
    let beside = missing.parent().unwrap_or(Path::new(""));
    let mut near = alike(missing, beside);
    if beside != Path::new(SHIPPED) {
        near.extend(alike(missing, Path::new(SHIPPED)));
    }
    near.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(&b.1)));
    near.into_iter().take(MOST).map(|(_, path)| path).collect()
}

/// The worlds of a folder whose names are like that of `missing`, and how much.
fn alike(missing: &Path, folder: &Path) -> Vec<(f64, PathBuf)> {
    let stem = |path: &Path| {
        path.file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .to_lowercase()
    };
    let wanted = stem(missing);
    let listed = match folder.as_os_str().is_empty() {
        true => Path::new("."),
        false => folder,
    };
    let entries = listed.read_dir().into_iter().flatten().flatten();
    let paths = entries.map(|entry| folder.join(entry.file_name()));
    let worlds = paths.filter(|path| path.extension().is_some_and(|end| end == "json"));
    let ranked = worlds.map(|path| (strsim::jaro_winkler(&wanted, &stem(&path)), path));
    ranked.filter(|(likeness, _)| *likeness > 0.8).collect()
}
