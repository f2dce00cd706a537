//! Any bytes as a recording.
#![no_main]

use std::path::Path;

use xcscr::record::reader::Recording;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Ok(recording) = Recording::from_bytes(Path::new("fuzz.mcap"), bytes.to_vec()) {
        recording.messages().for_each(drop);
    }
});
