//! Any text as a file of rules.
#![no_main]

use xcscr::agent::Knowledge;

libfuzzer_sys::fuzz_target!(|text: &[u8]| {
    if let Ok(known) = serde_json::from_slice::<Knowledge>(text) {
        let percept = "0110110101101101".parse().expect("sixteen bits are a percept");
        let _ = known.check(16, 4);
        known.values(&percept, 4).best_actions().for_each(drop);
    }
});
