//! Helpers for the contents of folders.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Replaces a file, for tests that write thousands of files. Deletes the file first: on ext4,
/// truncating and rewriting a file flushes it to disk at once, which takes 150 times as long.
pub fn replace(path: &Path, bytes: impl AsRef<[u8]>) {
    // The file may not exist yet.
    let _ = fs::remove_file(path);
    fs::write(path, bytes).unwrap();
}

/// Copies a folder of files and folders.
pub fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap().map(Result::unwrap) {
        let target = to.join(entry.file_name());
        match entry.path().is_dir() {
            true => copy(&entry.path(), &target),
            false => drop(fs::copy(entry.path(), target).unwrap()),
        }
    }
}

/// Returns the sorted names of the files in a folder.
pub fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// Returns every file of a folder with its bytes, sorted by name. The journals of a study stand for their
/// trials, because their number and order depend on the processes that ran it.
pub fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(folder).unwrap().map(Result::unwrap);
    let mut files: Vec<_> = entries
        .map(|entry| {
            let name = entry.file_name().into_string().unwrap();
            let bytes = match name == "journals" {
                true => trials(&entry.path()).into_iter().collect::<String>().into(),
                false => fs::read(entry.path()).unwrap(),
            };
            (name, bytes)
        })
        .collect();
    files.sort();
    files
}

/// The lines of finished trials in a folder of journals, each once.
fn trials(journals: &Path) -> BTreeSet<String> {
    let texts = contents(journals)
        .into_iter()
        .map(|(_, bytes)| String::from_utf8(bytes).unwrap());
    texts
        .flat_map(|text| {
            text.split_inclusive('\n')
                .skip(1)
                .map(str::to_owned)
                .collect::<Vec<_>>()
        })
        .filter(|line| line.ends_with('\n'))
        .collect()
}

/// The journal of a study that one process ran.
pub fn journal(study: &Path) -> PathBuf {
    let journals = study.join("journals");
    let names = names(&journals);
    assert_eq!(names.len(), 1, "{names:?}");
    journals.join(&names[0])
}

/// Two folders hold the same files with the same bytes.
#[track_caller]
pub fn assert_same(found: &Path, wanted: &Path, what: &str) {
    assert_equal(&contents(found), &contents(wanted), what);
}

/// Two studies have the same results and trials, whatever their numbers of tasks.
#[track_caller]
pub fn assert_same_study(found: &Path, wanted: &Path, what: &str) {
    let [found, wanted] = [found, wanted].map(|study| {
        let mut files = contents(study);
        files.retain(|(name, _)| name != "study.json");
        files
    });
    assert_equal(&found, &wanted, what);
}

#[track_caller]
fn assert_equal(found: &[(String, Vec<u8>)], wanted: &[(String, Vec<u8>)], what: &str) {
    let names = |files: &[(String, Vec<u8>)]| -> Vec<String> {
        files.iter().map(|(name, _)| name.clone()).collect()
    };
    assert_eq!(names(found), names(wanted), "{what}");
    for ((name, a), (_, b)) in found.iter().zip(wanted) {
        assert!(a == b, "{what}: {name} differs");
    }
}
