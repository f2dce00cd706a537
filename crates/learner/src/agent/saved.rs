//! What a method keeps from one episode to the next, as bytes.

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::agent::Agent;

/// Why a learner cannot resume from what was saved.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RestoreError {
    /// The bytes do not make a learner.
    #[error("the learner cannot be read: {0}")]
    Unreadable(String),
    /// They make a learner, but one that the settings rule out.
    #[error("the learner was made with other settings")]
    Foreign,
}

/// The bytes of what learning has changed. Settings are no part of it: whoever resumes has them.
pub(super) fn bytes_of(state: &impl Serialize) -> Vec<u8> {
    postcard::to_allocvec(state).expect("a learner is plain data and a vector has room")
}

/// What learning had changed, from its bytes.
pub(super) fn read<T: DeserializeOwned>(saved: &[u8]) -> Result<T, RestoreError> {
    let (state, rest) = postcard::take_from_bytes(saved)
        .map_err(|fault| RestoreError::Unreadable(fault.to_string()))?;
    match rest.is_empty() {
        true => Ok(state),
        false => Err(RestoreError::Unreadable(
            "bytes are left over at its end".to_owned(),
        )),
    }
}

/// A method that has resumed, if it could take up all of its memory.
pub(super) fn accept(
    method: impl Agent + 'static,
    fits: bool,
) -> Result<Box<dyn Agent>, RestoreError> {
    match fits {
        true => Ok(Box::new(method)),
        false => Err(RestoreError::Foreign),
    }
}
