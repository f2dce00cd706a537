//! Any text as a file of rules.
#![no_main]

use std::sync::LazyLock;

use xcscr::agent::Knowledge;
use xcscr::sensor::Sensor;
use xcscr::world::Maze;

static MAZE: LazyLock<Maze> = LazyLock::new(|| {
    let text = br######"{ "rows": ["#####", "#S..#", "###G#", "#####"] }"######;
    Maze::from_json(text, "corner.json").expect("a world")
});

libfuzzer_sys::fuzz_target!(|text: &[u8]| {
    if let Ok(known) = serde_json::from_slice::<Knowledge>(text) {
        let percept = "0110110101101101".parse().expect("sixteen bits are a percept");
        let _ = known.check(Sensor::Neighbours, &MAZE);
        known.values(&percept, 4).best_actions().for_each(drop);
    }
});
