//! Any bytes as what a checkpoint holds. Without its seal, whose check sum would stop the fuzzer.
#![no_main]

use xcscr::trial::{Checkpoint, Trial};

libfuzzer_sys::fuzz_target!(|content: &[u8]| {
    if let Ok(checkpoint) = postcard::from_bytes::<Checkpoint>(content) {
        let _ = Trial::resume(&checkpoint);
    }
});
