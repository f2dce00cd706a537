//! The open files, and the distribution of messages to them.

use foxglove::Encode;
use serde::Serialize;

use super::log_file::OpenFile;
use crate::error::Error;
use crate::record::event;
use crate::record::topics::Topic;

/// The open files that a message is written to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum For {
    /// The episode's file.
    Episode,
    /// The file of the whole run.
    Run,
    /// Both.
    Both,
}

/// The open files. Each file accepts the topics that it declared.
#[derive(Default)]
pub(super) struct Outbox {
    pub run: Option<OpenFile>,
    pub episode: Option<OpenFile>,
    scratch: Vec<u8>,
}

impl Outbox {
    /// Sends a well-known message.
    pub fn send(
        &mut self,
        to: For,
        topic: Topic,
        time_ns: u64,
        message: &impl Encode,
    ) -> Result<(), Error> {
        self.scratch.clear();
        message
            .encode(&mut self.scratch)
            .expect("a vector has room for any message");
        self.deliver(to, topic, time_ns)
    }

    /// Sends a fact.
    pub fn send_json(
        &mut self,
        to: For,
        topic: Topic,
        time_ns: u64,
        fact: &impl Serialize,
    ) -> Result<(), Error> {
        self.scratch.clear();
        event::write_json(&mut self.scratch, fact);
        self.deliver(to, topic, time_ns)
    }

    fn deliver(&mut self, to: For, topic: Topic, time_ns: u64) -> Result<(), Error> {
        let episode = self.episode.as_mut().filter(|_| to != For::Run);
        let run = self.run.as_mut().filter(|_| to != For::Episode);
        for file in episode.into_iter().chain(run) {
            file.with(|log| log.message(topic, time_ns, &self.scratch))?;
        }
        Ok(())
    }
}
