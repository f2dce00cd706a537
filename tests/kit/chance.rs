//! Reproducible random experiments.

use xcscr::streams::StreamName;
use xcscr::xcs::random::Stream;

/// Returns the number of repetitions of a random experiment: `commit`, or `long` if the environment
/// variable `XCSCR_LONG` is set.
pub fn rounds(commit: usize, long: usize) -> usize {
    match std::env::var_os("XCSCR_LONG") {
        Some(_) => long,
        None => commit,
    }
}

/// Creates a random stream that is the same in every run.
pub fn dice(seed: u64) -> Stream {
    Stream::new(seed, StreamName::World)
}
