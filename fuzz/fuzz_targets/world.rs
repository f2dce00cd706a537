//! Any text as a world file.
#![no_main]

libfuzzer_sys::fuzz_target!(|text: &[u8]| {
    let maze = xcscr::world::Maze::from_json(text, "fuzz.json");
    let _ = maze.map_err(|error| error.to_string());
});
