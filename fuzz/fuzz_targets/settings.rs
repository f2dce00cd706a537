//! Any text as a settings file.
#![no_main]

use xcscr::trial::{Resolved, Settings};

libfuzzer_sys::fuzz_target!(|text: &str| {
    if let Ok(resolved) = Resolved::new(&Settings::default(), &[("fuzz.toml", text)], &[]) {
        resolved.settings.check().expect("resolved settings are checked");
    }
});
