//! Recording modes: which episodes are kept.

use std::fmt;
use std::num::NonZeroU32;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// Which episodes get a file, and what the file contains. All modes but [`None`](Self::None) also
/// write `run.mcap`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RecordMode {
    /// Every episode.
    #[default]
    All,
    /// The first episode and every n-th after it: `every:50` keeps episodes 1, 51, 101, ...
    Every(NonZeroU32),
    /// Every episode, with the measurement of each lidar beam.
    Beams,
    /// No files at all.
    None,
}

impl RecordMode {
    /// Returns true if this episode is written.
    pub fn wants(self, episode: u32) -> bool {
        match self {
            Self::All | Self::Beams => true,
            Self::Every(n) => episode.saturating_sub(1).is_multiple_of(n.get()),
            Self::None => false,
        }
    }
}

/// A text that is not a valid [`RecordMode`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a recording mode: expected all, every:N (N from 1), beams, or none")]
pub struct RecordModeError(String);

impl FromStr for RecordMode {
    type Err = RecordModeError;

    fn from_str(text: &str) -> Result<Self, RecordModeError> {
        let mode = match text {
            "all" => Some(Self::All),
            "beams" => Some(Self::Beams),
            "none" => Some(Self::None),
            _ => text
                .strip_prefix("every:")
                .and_then(|n| n.parse().ok())
                .map(Self::Every),
        };
        mode.ok_or_else(|| RecordModeError(text.to_owned()))
    }
}

impl fmt::Display for RecordMode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::All => f.write_str("all"),
            Self::Every(n) => write!(f, "every:{n}"),
            Self::Beams => f.write_str("beams"),
            Self::None => f.write_str("none"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mode_prints_as_it_was_read() {
        for text in ["all", "every:50", "beams", "none"] {
            assert_eq!(text.parse::<RecordMode>().unwrap().to_string(), text);
        }
    }

    #[test]
    fn every_zeroth_episode_is_refused() {
        for text in ["every:0", "every:", "every:-1", "All", ""] {
            assert!(text.parse::<RecordMode>().is_err(), "{text}");
        }
    }

    #[test]
    fn every_n_begins_with_the_first_episode() {
        let mode: RecordMode = "every:3".parse().unwrap();
        let kept: Vec<u32> = (1..=8).filter(|&e| mode.wants(e)).collect();
        assert_eq!(kept, [1, 4, 7]);
    }
}
