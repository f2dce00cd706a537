//! Any text as a study file.
#![no_main]

use std::path::Path;

use xcscr::study::{Agents, Protocol, StudyFile};

libfuzzer_sys::fuzz_target!(|text: &str| {
    let file = StudyFile::parse(text, "fuzz.toml", Path::new("no/such/folder"));
    let _ = file.and_then(|file| Protocol::new(&file, &Agents::default()));
});
