//! Serialised trials between two episodes.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::Progress;
use super::plan::{Config, Plan, PlanError};
use crate::agent::RestoreError;
use xcs::random::Stream;
use xcscr_robot::arena::Lasting;
use xcscr_robot::world::{Maze, WorldError};

/// The magic bytes at the beginning of the file.
const MAGIC: &[u8; 8] = b"xcscr\x1a\r\n";
/// The version of the file format.
const FORMAT: u32 = 13;
/// The size of magic, format and length before the content. A checksum of `TAIL` bytes follows it.
const HEAD: usize = MAGIC.len() + 4 + 8;
const TAIL: usize = 4;

/// A trial between two episodes. A trial that resumes from it gives the same bytes as one that
/// never stopped. Made by [`Trial::checkpoint`](super::Trial::checkpoint).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    pub(super) config: Config,
    pub(super) world: String,
    pub(super) progress: Progress,
    pub(super) method: Vec<u8>,
    pub(super) arena: Lasting,
    pub(super) exploration: Stream,
    pub(super) starts: Stream,
}

impl Checkpoint {
    /// Returns the plan of the trial.
    ///
    /// # Errors
    /// When world and settings do not make a valid plan.
    pub fn plan(&self) -> Result<Plan, CheckpointError> {
        let plan = Plan {
            maze: Maze::from_json(self.world.as_bytes(), "world.json")?,
            config: self.config.clone(),
        };
        plan.check()?;
        Ok(plan)
    }

    /// Returns the progress of the trial.
    pub fn progress(&self) -> &Progress {
        &self.progress
    }
}

/// Errors when using a checkpoint.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The bytes are not a checkpoint.
    #[error("it is not a checkpoint")]
    Foreign,
    /// The checkpoint has another format.
    #[error(
        "it has format {found}, and this version reads format {FORMAT}; resume with the version that wrote it, or begin anew with `--force`"
    )]
    Format {
        /// The format of the file.
        found: u32,
    },
    /// The checkpoint was written by another version, whose output may differ.
    #[error("it was written by version {found}, and this is version {}; resume with that version, or begin anew with `--force`", env!("CARGO_PKG_VERSION"))]
    Version {
        /// The version that wrote the file.
        found: String,
    },
    /// The actual length differs from the stored length.
    #[error("it has {found} bytes, but should have {wanted}")]
    Length {
        /// The actual number of bytes.
        found: usize,
        /// The stored number of bytes.
        wanted: u64,
    },
    /// The checksum does not match.
    #[error("its checksum is wrong")]
    Crc,
    /// The content is inconsistent.
    #[error("its content is inconsistent: {0}")]
    Content(String),
    /// The plan cannot be run.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The world is invalid.
    #[error(transparent)]
    World(#[from] WorldError),
    /// The learner cannot be restored.
    #[error(transparent)]
    Memory(#[from] RestoreError),
}

/// Returns true if these bytes begin like a checkpoint.
pub fn is_sealed(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Serialises a value to a checkpoint: magic, format, length, version and value, checksum.
pub fn seal(value: &impl Serialize) -> Vec<u8> {
    let mut bytes = [MAGIC, &FORMAT.to_le_bytes()[..], &[0; 8]].concat();
    bytes = postcard::to_extend(&(env!("CARGO_PKG_VERSION"), value), bytes)
        .expect("a checkpoint is plain data and a vector has room");
    let length = (bytes.len() + TAIL) as u64;
    bytes[HEAD - 8..HEAD].copy_from_slice(&length.to_le_bytes());
    bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
    bytes
}

/// Reads a value from bytes made by [`seal`].
///
/// # Errors
/// The first fault. Every missing or changed byte is detected.
pub fn unseal<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, CheckpointError> {
    let content = content(bytes)?;
    let unread = |fault: postcard::Error| CheckpointError::Content(fault.to_string());
    let (version, content): (String, _) = postcard::take_from_bytes(content).map_err(unread)?;
    if version != env!("CARGO_PKG_VERSION") {
        return Err(CheckpointError::Version { found: version });
    }
    match postcard::take_from_bytes(content).map_err(unread)? {
        (value, []) => Ok(value),
        _ => Err(CheckpointError::Content(
            "bytes are left over at its end".to_owned(),
        )),
    }
}

/// Returns the bytes between head and tail, if both are valid.
fn content(bytes: &[u8]) -> Result<&[u8], CheckpointError> {
    let rest = bytes.strip_prefix(MAGIC).ok_or(CheckpointError::Foreign)?;
    let (format, rest) = rest.split_first_chunk().ok_or(CheckpointError::Foreign)?;
    let format = u32::from_le_bytes(*format);
    if format != FORMAT {
        return Err(CheckpointError::Format { found: format });
    }
    let (length, rest) = rest.split_first_chunk().ok_or(CheckpointError::Foreign)?;
    let (found, wanted) = (bytes.len(), u64::from_le_bytes(*length));
    let (content, crc) = rest
        .split_last_chunk()
        .filter(|_| found as u64 == wanted)
        .ok_or(CheckpointError::Length { found, wanted })?;
    if crc32fast::hash(&bytes[..found - TAIL]) != u32::from_le_bytes(*crc) {
        return Err(CheckpointError::Crc);
    }
    Ok(content)
}
