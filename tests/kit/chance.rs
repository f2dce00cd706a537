//! Reproducible random experiments.

use xcscr::streams::StreamName;
use xcscr::xcs::random::Stream;

/// Returns the number of repetitions of a random experiment: in the fast suite, in the long suite, and
/// in the long suite if the environment variable `XCSCR_LONG` is set.
pub fn rounds([fast, long, hours]: [usize; 3]) -> usize {
    match std::env::var_os("XCSCR_LONG") {
        _ if cfg!(not(feature = "long")) => fast,
        Some(_) => hours,
        None => long,
    }
}

/// Creates a random stream that is the same in every run.
pub fn dice(seed: u64) -> Stream {
    Stream::new(seed, StreamName::World)
}
