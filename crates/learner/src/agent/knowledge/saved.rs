//! Serialisation of learner states.

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::agent::Agent;

/// Errors when resuming a learner from a checkpoint.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RestoreError {
    /// The bytes are not a learner.
    #[error("the learner cannot be read: {0}")]
    Unreadable(String),
    /// The learner does not fit the settings.
    #[error("the learner was made with other settings")]
    Foreign,
}

/// Serialises the learned state. Settings are not included; the caller that resumes has them.
pub(in crate::agent) fn bytes_of(state: &impl Serialize) -> Vec<u8> {
    postcard::to_allocvec(state).expect("a learner is plain data and a vector has room")
}

/// Deserialises a learned state.
pub(in crate::agent) fn read<T: DeserializeOwned>(saved: &[u8]) -> Result<T, RestoreError> {
    let (state, rest) = postcard::take_from_bytes(saved)
        .map_err(|fault| RestoreError::Unreadable(fault.to_string()))?;
    match rest.is_empty() {
        true => Ok(state),
        false => Err(RestoreError::Unreadable(
            "bytes are left over at its end".to_owned(),
        )),
    }
}

/// An agent whose learned state is one value, validated once when an agent resumes from it.
pub(in crate::agent) trait Saved: Agent + Clone + 'static {
    /// What learning changes, without settings.
    type State: Serialize + DeserializeOwned;

    /// Returns the learned state.
    fn state(&self) -> Self::State;

    /// Continues from a state; `None` if it is damaged, or was made with other settings.
    fn resumed(self, state: Self::State) -> Option<Self>;

    /// Implements [`Agent::checkpoint`].
    fn saved(&self) -> Vec<u8> {
        bytes_of(&self.state())
    }

    /// Implements [`Agent::restore`].
    fn read(&self, saved: &[u8]) -> Result<Box<dyn Agent>, RestoreError> {
        let method = self.clone().resumed(read(saved)?);
        Ok(Box::new(method.ok_or(RestoreError::Foreign)?))
    }
}
