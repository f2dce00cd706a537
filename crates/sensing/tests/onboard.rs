//! The onboard computer uses sensor readings only.

use std::fs;
use std::path::{Path, PathBuf};

/// Names of the simulated truth in this crate. The compiler keeps the types of other crates out.
const TRUTH: [&str; 4] = ["sensors", "Moment", "Terrain", "Sample"];

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    entries
        .flat_map(|path| match path.is_dir() {
            true => rust_files(&path),
            false => vec![path],
        })
        .collect()
}

/// The names of the truth in the code of a file, without its comments.
fn truths_in(text: &str) -> Vec<&'static str> {
    let code: Vec<&str> = text
        .lines()
        .filter_map(|line| line.split("//").next())
        .collect();
    let code = code.join("\n");
    let words: Vec<&str> = code
        .split(|c: char| !(c.is_alphanumeric() || c == '_'))
        .collect();
    TRUTH
        .into_iter()
        .filter(|name| words.contains(name))
        .collect()
}

#[test]
fn no_file_of_the_onboard_computer_names_the_sensors_or_the_truth() {
    let files = rust_files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src/onboard"));
    assert!(files.len() >= 8, "only {} files", files.len());
    for file in files {
        let found = truths_in(&fs::read_to_string(&file).unwrap());
        assert!(found.is_empty(), "{} names {found:?}", file.display());
    }
}

#[test]
fn control_the_truth_is_found_in_code_and_not_in_comments() {
    assert_eq!(
        truths_in("use crate::sensors::{Moment, Terrain};"),
        ["sensors", "Moment", "Terrain"]
    );
    assert!(truths_in("/// See the Sample.\nuse crate::readings::Readings;").is_empty());
}
