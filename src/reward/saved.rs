//! What a method keeps from one episode to the next, as bytes.

use serde::Serialize;
use serde::de::DeserializeOwned;

/// Why a learner cannot go on from what was saved.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SavedError {
    /// The bytes do not make a learner.
    #[error("the learner cannot be read: {0}")]
    Unreadable(String),
    /// They make a learner, but one that the settings rule out.
    #[error("the learner was made with other settings")]
    Foreign,
}

/// The bytes of a method.
pub(super) fn bytes(method: &impl Serialize) -> Vec<u8> {
    postcard::to_allocvec(method).expect("a learner is plain data and a vector has room")
}

/// The method whose bytes these are, if it `descends` from one that began as `fresh`.
pub(super) fn recall<T: DeserializeOwned>(
    bytes: &[u8],
    fresh: &T,
    descends: fn(&T, &T) -> bool,
) -> Result<T, SavedError> {
    let (method, rest) = postcard::take_from_bytes(bytes)
        .map_err(|fault| SavedError::Unreadable(fault.to_string()))?;
    if !rest.is_empty() {
        return Err(SavedError::Unreadable("it is too long".to_owned()));
    }
    Some(method)
        .filter(|method| descends(method, fresh))
        .ok_or(SavedError::Foreign)
}
