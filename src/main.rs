//! The command line of xcscr.
fn main() {}
