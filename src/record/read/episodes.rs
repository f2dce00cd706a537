//! The figures of the finished episodes of a recording.

use serde::Deserialize;

use super::reader::{Message, Recording};
use crate::error::Error;
use crate::record::topics::Topic;

/// The figures of an episode that pages and summaries show.
#[derive(Debug, Deserialize)]
pub struct Figures {
    /// The episode's number.
    pub episode: u32,
    /// `goal`, `step-limit`, or `running` for a message at the start of the episode.
    pub outcome: String,
    /// True if the policy is globally optimal.
    pub optimal: bool,
    /// The number of steps.
    pub steps: Option<u32>,
    /// The number of collisions.
    pub collisions: Option<u32>,
    /// The number of rules.
    pub rules: Option<u32>,
    /// The number of steps of the shortest path.
    pub shortest: Option<u32>,
}

impl Recording {
    /// Returns the figures of all finished episodes.
    ///
    /// # Errors
    /// If the recording is damaged.
    pub fn episodes(&self) -> Result<Vec<Figures>, Error> {
        let mut episodes = Vec::new();
        for message in self.messages() {
            let message = message?;
            if Topic::named(message.topic()) == Some(Topic::Episode) {
                let figures = self.figures(&message)?;
                episodes.extend((figures.outcome != "running").then_some(figures));
            }
        }
        Ok(episodes)
    }
    /// Returns the figures in a message of `/episode`.
    pub(in crate::record) fn figures(&self, message: &Message) -> Result<Figures, Error> {
        serde_json::from_slice(&message.data)
            .map_err(|fault| self.damaged(format!("/episode: {fault}")))
    }
}
