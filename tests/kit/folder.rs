//! What stands in a folder.

use std::fs;
use std::path::Path;

/// Puts a file where there may be one, as tests do that try thousands of files. It is made anew: one
/// that is cut to nothing and written again goes to the disk at once on ext4, which takes 150 times as long.
pub fn replace(path: &Path, bytes: impl AsRef<[u8]>) {
    // There may be none yet.
    let _ = fs::remove_file(path);
    fs::write(path, bytes).unwrap();
}

/// The names of the files in a folder, in order.
pub fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// Every file of a folder with its bytes, in order.
pub fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(folder).unwrap().map(Result::unwrap);
    let mut files: Vec<_> = entries
        .map(|entry| {
            let name = entry.file_name().into_string().unwrap();
            (name, fs::read(entry.path()).unwrap())
        })
        .collect();
    files.sort();
    files
}

/// Two folders hold the same files with the same bytes.
#[track_caller]
pub fn assert_same(found: &Path, wanted: &Path, what: &str) {
    let (found, wanted) = (contents(found), contents(wanted));
    let names = |files: &[(String, Vec<u8>)]| -> Vec<String> {
        files.iter().map(|(name, _)| name.clone()).collect()
    };
    assert_eq!(names(&found), names(&wanted), "{what}");
    for ((name, a), (_, b)) in found.iter().zip(&wanted) {
        assert!(a == b, "{what}: {name} differs");
    }
}
