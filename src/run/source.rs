//! What run a recording comes from.

use std::path::Path;

use super::error::RunError;
use crate::record::RecordMode;
use crate::record::reader::Recording;
use crate::trial::Plan;
use crate::world::Maze;

/// Where a recording says that it comes from.
pub struct Source {
    /// How to run it again.
    pub plan: Plan,
    /// Which episodes were kept.
    pub mode: RecordMode,
    /// The episode that it shows; `None` for the whole run.
    pub episode: Option<u32>,
    /// The whole file.
    pub bytes: Vec<u8>,
}

impl Source {
    /// Reads a recording.
    ///
    /// # Errors
    /// When the file cannot be read, or does not say where it comes from.
    pub fn of(file: &Path) -> Result<Self, RunError> {
        let recording = Recording::open(file)?;
        let damaged = |fault: String| RunError::Recording {
            file: file.to_owned(),
            fault,
        };
        let attached = |name: &str| {
            let missing = || damaged(format!("the attachment {name} is missing"));
            recording.attachment(name).ok_or_else(missing)
        };
        let config = serde_json::from_slice(attached("config.json")?)
            .map_err(|fault| damaged(format!("config.json: {fault}")))?;
        let maze = Maze::from_json(attached("world.json")?, "world.json")?;
        let metadata = recording.metadata("run");
        let entry = |key: &str| metadata.and_then(|m| m.get(key)).map_or("", String::as_str);
        let mode = entry("record")
            .parse()
            .map_err(|fault| damaged(format!("{fault}")))?;
        Ok(Self {
            plan: Plan { maze, config },
            mode,
            episode: entry("episode").parse().ok(),
            bytes: recording.bytes().to_vec(),
        })
    }
}
