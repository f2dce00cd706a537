//! Actions.

use serde::{Deserialize, Serialize};

/// The largest number of actions of a learner with ternary conditions.
pub const MAX_ACTIONS: usize = 8;
/// The largest number of actions of a learner with interval conditions.
pub const WIDE_ACTIONS: usize = 256;

/// A value for each of [`MAX_ACTIONS`] actions, including those that an environment lacks.
pub type ByAction<T> = [T; MAX_ACTIONS];

/// An action: one of `0..n`, where `n` is the number of actions of an environment, at most [`WIDE_ACTIONS`].
///
/// The learner knows only the number; the environment defines its meaning.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Action(u8);

impl Action {
    /// Returns action number `index`; `None` from [`WIDE_ACTIONS`] on.
    pub fn new(index: usize) -> Option<Self> {
        u8::try_from(index).ok().map(Self)
    }

    /// Returns the first `count` actions (at most [`WIDE_ACTIONS`]), in order.
    pub fn all(count: usize) -> impl DoubleEndedIterator<Item = Self> + Clone {
        (0..count.min(WIDE_ACTIONS)).map(|index| Self(index as u8))
    }

    /// Returns the number of this action, counted from 0.
    #[inline]
    pub fn index(self) -> usize {
        usize::from(self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_action_beyond_the_last_does_not_exist() {
        let read = |index: usize| serde_json::from_str::<Action>(&index.to_string());
        let last = Action::new(WIDE_ACTIONS - 1);
        assert_eq!(read(WIDE_ACTIONS - 1).ok(), last);
        assert_eq!(Action::all(WIDE_ACTIONS + 1).last(), last);
        assert!(Action::new(WIDE_ACTIONS).is_none());
        assert!(read(WIDE_ACTIONS).is_err());
    }
}
