//! Any bytes as a checkpoint.
#![no_main]

use xcscr::study::{Checkpoint, Trial, unseal};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Ok(checkpoint) = unseal::<Checkpoint>(bytes) {
        let _ = Trial::resume(&checkpoint);
    }
});
