//! Random experiments, the same in every run.

use xcscr::streams::StreamName;
use xcscr::xcs::random::Stream;

/// How often a random experiment is repeated: `commit` times, or `long` times when the
/// environment variable `XCSCR_LONG` is set.
pub fn rounds(commit: usize, long: usize) -> usize {
    match std::env::var_os("XCSCR_LONG") {
        Some(_) => long,
        None => commit,
    }
}

/// Random numbers for tests: the same in every run.
pub fn dice(seed: u64) -> Stream {
    Stream::new(seed, StreamName::World)
}
