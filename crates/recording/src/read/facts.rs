//! The facts of a recording.

use serde::de::DeserializeOwned;

use super::reader::{Message, Recording};
use crate::error::Error;
use crate::event::End;
use crate::topics::Topic;

impl Recording {
    /// Returns the figures of all finished episodes.
    ///
    /// # Errors
    /// If the recording is damaged.
    pub fn episodes(&self) -> Result<Vec<End>, Error> {
        let mut episodes = Vec::new();
        for message in self.messages() {
            let message = message?;
            if Topic::named(message.topic()) == Some(Topic::Episode) {
                episodes.push(self.fact(&message)?);
            }
        }
        Ok(episodes)
    }

    /// Returns the fact in a message.
    ///
    /// # Errors
    /// When the message is not JSON of this fact.
    pub fn fact<F: DeserializeOwned>(&self, message: &Message) -> Result<F, Error> {
        let fact = serde_json::from_slice(&message.data);
        fact.map_err(|fault| self.damaged(format!("{}: {fault}", message.topic())))
    }
}
