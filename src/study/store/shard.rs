//! Shards: parts of a study for several machines.

use std::fmt;
use std::str::FromStr;

/// Shard `index` of `count`, counted from 1: every `count`-th trial.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    index: usize,
    count: usize,
}

impl Shard {
    /// The shard with all trials.
    pub const WHOLE: Self = Self { index: 1, count: 1 };

    /// Returns true if the trial belongs to this shard.
    pub fn holds(self, trial: usize) -> bool {
        trial % self.count == self.index - 1
    }

    /// Returns shard `index` of `count`, or `None` if there is no such shard.
    pub fn nth(index: usize, count: usize) -> Option<Self> {
        let exists = (1..=count).contains(&index);
        exists.then_some(Self { index, count })
    }

    /// Returns all `count` shards.
    pub fn all(count: usize) -> impl Iterator<Item = Self> {
        (1..=count).map(move |index| Self { index, count })
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text
            .split_once('/')
            .and_then(|(index, count)| Self::nth(index.parse().ok()?, count.parse().ok()?));
        numbers.ok_or_else(|| "write shard 2 of 7 as 2/7; shards are counted from 1".to_owned())
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_trial_belongs_to_one_shard() {
        for trial in 0..50 {
            assert_eq!(Shard::all(7).filter(|shard| shard.holds(trial)).count(), 1);
        }
    }

    #[test]
    fn only_existing_shards_are_parsed() {
        assert_eq!("2/7".parse(), Ok(Shard { index: 2, count: 7 }));
        for text in ["0/7", "8/7", "1/0", "2", "a/b", "-1/2"] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
    }
}
