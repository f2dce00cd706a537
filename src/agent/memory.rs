//! What a method keeps from one episode to the next, as bytes.

use serde::Serialize;
use serde::de::DeserializeOwned;

/// Why a learner cannot resume from what was saved.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MemoryError {
    /// The bytes do not make a learner.
    #[error("the learner cannot be read: {0}")]
    Unreadable(String),
    /// They make a learner, but one that the settings rule out.
    #[error("the learner was made with other settings")]
    Foreign,
}

/// The memory of a method.
pub(super) fn of(method: &impl Serialize) -> Vec<u8> {
    postcard::to_allocvec(method).expect("a learner is plain data and a vector has room")
}

/// The method whose memory this is, if it could come of the settings.
pub(super) fn recall<T: DeserializeOwned>(
    saved: &[u8],
    belongs: impl FnOnce(&T) -> bool,
) -> Result<T, MemoryError> {
    let (method, rest) = postcard::take_from_bytes(saved)
        .map_err(|fault| MemoryError::Unreadable(fault.to_string()))?;
    if !rest.is_empty() {
        return Err(MemoryError::Unreadable("it is too long".to_owned()));
    }
    Some(method).filter(belongs).ok_or(MemoryError::Foreign)
}
